import { ReactFlowProvider } from "@xyflow/react";
import "@xyflow/react/dist/style.css";
import { type ReactNode, useMemo, useState } from "react";
import { networksOf, nodesOf } from "../../lib/network";
import { useDesign } from "../../lib/store";
import { findPart } from "../../lib/tree";
import { Blocks } from "./canvas/Blocks";
import { NetworkView } from "./canvas/NetworkView";

interface Props {
  level: string;
  chosen: string[];
  choose: (paths: string[]) => void;
  open: (level: string) => void;
}

/** A level as its block diagram, or one of its networks as nodes and links. */
export function Canvas(props: Props): ReactNode {
  const design = useDesign();
  const part = design ? findPart(design, props.level) : undefined;
  const networks = useMemo(() => networksOf(part?.values.diagram), [part]);
  const [asked, setAsked] = useState<{ level: string; network: number } | null>(null); // of which level a network, -1: the blocks
  const alone = networks.length === 1 && networks[0]!.place.length === 2; // the level is a network, and nothing else
  const wanted = asked?.level === props.level ? asked.network : alone ? 0 : -1;
  const shown = part ? networks[wanted] : undefined;
  return (
    <>
      {networks.length > 0 && (
        <div className="row views" role="group" aria-label="Drawn as">
          {["Blocks", ...networks.map(({ network }) => `Network ${nodesOf(network).slice(0, 3).join(", ")}…`)].map((name, i) => (
            <button key={i} aria-pressed={shown ? wanted === i - 1 : i === 0} onClick={() => setAsked({ level: props.level, network: i - 1 })}>
              {name}
            </button>
          ))}
        </div>
      )}
      <ReactFlowProvider key={shown ? "network" : "blocks"}>
        {part && shown ? <NetworkView key={props.level} level={part} place={shown.place} network={shown.network} chosen={props.chosen} choose={props.choose} /> : <Blocks {...props} />}
      </ReactFlowProvider>
    </>
  );
}
