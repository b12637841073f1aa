import type { Node, NodeProps } from "@xyflow/react";
import type { ReactNode } from "react";
import type { Shapes } from "../../../lib/api";
import { useShared } from "../../../lib/store";
import { colouring, markOf, useBlocks } from "./condition";
import { stem } from "./dragging";

export type TilesNode = Node<{ boxes: Shapes["Box"][]; width: number; level: string; chosen: string[]; choose: (path: string) => void }, "tiles">;

/** Boxes of a diagram that are few enough to be drawn one by one however far away they are. */
export const MANY = 200;

/** Many boxes seen from far away: a coloured tile each, and the name of a module where its parts begin. */
export function TilesView({ data: { boxes, width, level, chosen, choose } }: NodeProps<TilesNode>): ReactNode {
  const colour = useShared(colouring);
  const conditions = useBlocks();
  const module = (box?: Shapes["Box"]): string => box?.part?.slice(level ? level.length + 1 : 0).split("/").slice(0, -1)[0] ?? "";
  return (
    <svg className="tiles" aria-hidden="true" fontSize={width / 45}>
      {boxes.map((box, i) => {
        const path = box.part ? stem(box.part) : "";
        const mark = box.wrong?.length ? "wrong" : markOf(conditions.get(path), colour);
        return (
          <rect key={i} x={box.x} y={box.y} width={box.width} height={box.height} rx={6} className={`tile ${mark} ${path && chosen.includes(path) ? "chosen" : ""}`} onClick={() => path && choose(path)}>
            <title>{box.part ?? box.title}</title>
          </rect>
        );
      })}
      {boxes.map((box, i) =>
        module(box) && module(box) !== module(boxes[i - 1]) ? (
          <text key={i} x={box.x + 8} y={box.y + 0.85 * box.height}>
            {module(box)}
          </text>
        ) : null,
      )}
    </svg>
  );
}
