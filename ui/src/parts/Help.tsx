import type { ReactNode } from "react";
import { Dialog } from "./Dialog";

const KEYS: [string, string][] = [
  ["Ctrl+S", "save the design file, what was there kept as .bak, what was before as .bak.2 and so on"],
  ["Ctrl+Z, Ctrl+Y", "undo, redo: without limit, also after a reload"],
  ["Ctrl+K or /", "find a page, a part or a command"],
  ["F2", "rename the chosen part (Design)"],
  ["Ctrl+G", "put the chosen parts into a group (Design)"],
  ["M", "move the chosen parts to another level or group; on the canvas, drag them (Design)"],
  ["Delete", "delete the chosen parts; a message offers to undo it (Design)"],
  ["arrow keys, Space", "move in the tree, choose several parts (Design)"],
  ["Tab, Enter, Space", "on the canvas: go through boxes and links, choose one, several; Enter again opens a module (Design)"],
  ["?", "this"],
];

export function Help({ close }: { close: () => void }): ReactNode {
  return (
    <Dialog title="Keys and words" close={close}>
      <table>
        <tbody>
          {KEYS.map(([key, what]) => (
            <tr key={key}>
              <th scope="row">
                <kbd>{key}</kbd>
              </th>
              <td>{what}</td>
            </tr>
          ))}
        </tbody>
      </table>
      <p>
        <strong>Nominal</strong> is the robot as designed (solid lines), <strong>sensor-based</strong> follows the stress that
        its sensors measured (dashed). <strong>R</strong> is survival since new; hazard rate, remaining life and task completion
        (PoTC) are given that the robot works now. A silent sensor never counts as zero: its parts are marked stale.
      </p>
      <p>Edits are kept beside the design at once; the file itself changes when you save. Closing the browser stops nothing.</p>
    </Dialog>
  );
}
