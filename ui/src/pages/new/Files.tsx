import { type DragEvent, type ReactNode, useState } from "react";
import { useShared } from "../../lib/store";
import { Entry, FileButton } from "../../parts/Field";
import { change, going, handed, handIn, refused, said, takeAway } from "./state";

const KINDS = { description: "URDF", recording: "recording", "parts list": "parts list" };

/** Beside what a rosbag2 folder records lies what describes it: the recording alone is enough. */
const BESIDE = "metadata.yaml";

function sizeText(bytes: number): string {
  return bytes >= 1e9 ? `${(bytes / 1e9).toFixed(1)} GB` : bytes >= 1e6 ? `${(bytes / 1e6).toFixed(1)} MB` : `${Math.ceil(bytes / 1e3)} kB`;
}

/** Files that were dropped, those in folders among them. */
async function dropped(event: DragEvent): Promise<File[]> {
  const found = [...event.dataTransfer.items].map((one) => one.webkitGetAsEntry() ?? one.getAsFile()); // at once: later they are gone
  const files = await Promise.all(found.map((one) => (one === null ? [] : one instanceof File ? [one] : within(one))));
  return files.flat();
}

async function within(entry: FileSystemEntry): Promise<File[]> {
  if (entry.isFile) return [await new Promise<File>((resolve, reject) => (entry as FileSystemFileEntry).file(resolve, reject))];
  const reader = (entry as FileSystemDirectoryEntry).createReader();
  const inside: FileSystemEntry[] = [];
  for (;;) {
    const some = await new Promise<FileSystemEntry[]>((resolve, reject) => reader.readEntries(resolve, reject));
    if (!some.length) break;
    inside.push(...some); // a browser gives a hundred at a time
  }
  const found = await Promise.all(inside.map(within));
  return found.flat().filter((file) => file.name !== BESIDE);
}

/** What there is of the robot. */
export function Files(): ReactNode {
  const found = useShared(handed);
  const now = useShared(going);
  const wrong = useShared(refused);
  const { modules } = useShared(said);
  const [over, setOver] = useState(false);
  const files = found?.files ?? [];
  return (
    <section className="card">
      <h2>1. What you have of it</h2>
      <div
        className={`drop ${over ? "over" : ""}`}
        onDragOver={(event) => {
          event.preventDefault();
          setOver(true);
        }}
        onDragLeave={() => setOver(false)}
        onDrop={(event) => {
          event.preventDefault();
          setOver(false);
          void dropped(event).then(handIn);
        }}
      >
        <p>
          Drop its URDF, recordings ({found?.endings.recording?.join(", ")}, or a folder of them) and parts lists ({found?.endings["parts list"]?.join(", ")}) here, or
        </p>
        <FileButton label="Choose files" several={handIn} />
      </div>
      {now && (
        <p role="status">
          {now.name}: {now.share < 1 ? `${Math.round(100 * now.share)} %` : "is being read"} <progress aria-label={`${now.name} is handed in`} value={now.share} max={1} />
        </p>
      )}
      {wrong.length > 0 && (
        <div className="trouble" role="alert">
          {wrong.map((one) => (
            <p key={one}>{one}</p>
          ))}
        </div>
      )}
      {found && files.length + found.elsewhere.length === 0 && !now && (
        <p className="quiet">
          Nothing is here yet. A URDF tells of joints and their drives, a recording of sensors, signals and tasks, a parts list of boards. Without them the parts below are assumptions: answer
          the questions and add parts by their names.
        </p>
      )}
      <ul className="files">
        {found?.elsewhere.map((name) => (
          <li key={name}>
            <strong>{name}</strong> <span className="badge">recording</span> <span className="small quiet">named when the service was started</span>
          </li>
        ))}
        {files.map((one) => (
          <li key={one.name}>
            <strong>{one.name}</strong> <span className="badge">{KINDS[one.kind]}</span> <span className="small quiet">{sizeText(one.size)}</span>
            {one.kind === "parts list" && (
              <Entry label={`Module that ${one.name} is of`} hint="names with / between them, e.g. drive/board" value={modules[one.name] ?? `electronics/${one.name.replace(/\.[^.]*$/, "")}`} set={(module) => change({ modules: { ...modules, [one.name]: module } })} />
            )}
            <button aria-label={`Remove ${one.name}`} onClick={() => void takeAway(one.name)}>
              Remove
            </button>
          </li>
        ))}
      </ul>
    </section>
  );
}
