import { type ReactNode, useEffect, useState } from "react";
import { get, type Shapes } from "../lib/api";
import { useDesign } from "../lib/store";
import { Check, Select, Text } from "../parts/Field";
import { ICONS } from "../parts/Icon";
import { Tabs } from "../parts/Tabs";
import { LevelSelect } from "./parts/LevelSelect";
import { CurvePlots, type Curves } from "./analysis/CurvePlots";
import { Compare } from "./analysis/Compare";
import { CutSets } from "./analysis/CutSets";
import { FailureModes } from "./analysis/FailureModes";
import { FaultTree } from "./analysis/FaultTree";
import { FieldData } from "./analysis/FieldData";
import { Importance } from "./analysis/Importance";
import { WhatIf } from "./analysis/WhatIf";

export const page = { name: "Analysis", icon: ICONS.curve, order: 40 };

export default function Analysis(): ReactNode {
  const design = useDesign();
  const [tab, setTab] = useState("curves");
  if (!design) return null;
  return (
    <>
      <div className="head">
        <h1>Analysis</h1>
        <span className="quiet small">from now on, with all that is known of the robot's past</span>
      </div>
      {!design.valid ? (
        <div className="empty">
          <h2>Nothing to analyse yet</h2>
          <p>The design is not complete: its problems are listed above, under the button with their number.</p>
        </div>
      ) : (
        <>
          <Tabs label="Analysis" chosen={tab} choose={setTab} tabs={[["curves", "Curves"], ["importance", "What matters most"], ["cuts", "What it takes to fail"], ["tree", "Fault tree"], ["what-if", "What if"], ["modes", "Failure modes"], ["field", "Field data"], ["compare", "Compare"]]} />
          {tab === "curves" && <CurvesOf />}
          {tab === "importance" && <Importance />}
          {tab === "cuts" && <CutSets />}
          {tab === "tree" && <FaultTree />}
          {tab === "what-if" && <WhatIf />}
          {tab === "modes" && <FailureModes />}
          {tab === "field" && <FieldData />}
          {tab === "compare" && <Compare />}
        </>
      )}
    </>
  );
}

function CurvesOf(): ReactNode {
  const design = useDesign();
  const [path, setPath] = useState("");
  const [horizon, setHorizon] = useState("");
  const [state, setState] = useState("");
  const [log, setLog] = useState(false);
  const [states, setStates] = useState<Shapes["PastState"][]>([]);
  const [found, setFound] = useState<Curves | null>(null);
  const [other, setOther] = useState<Curves | null>(null);
  const [wrong, setWrong] = useState("");
  const hours = Number(horizon.replace(",", "."));
  const asked = horizon && hours > 0 ? hours : null;

  useEffect(() => void get("/api/design/states").then((one) => setStates(one.states)).catch(() => undefined), [design?.state]);
  useEffect(() => {
    let wanted = true;
    const fail = (error: Error): void => void (wanted && setWrong(error.message));
    get("/api/analysis/curves", { path, horizon: asked })
      .then(async (one) => {
        const second = state ? await get("/api/analysis/curves", { path, horizon: one.hours.at(-1), state }) : null;
        if (!wanted) return;
        setFound(one);
        setOther(second);
        setWrong("");
      })
      .catch(fail);
    return () => {
      wanted = false;
    };
  }, [path, asked, state, design?.state]);

  const past: [string, string][] = states.slice(1).map((one, i) => [String(one.state), `before “${states[i]?.what || "the last change"}”`]);
  return (
    <>
      <div className="fields">
        <LevelSelect label="Of" value={path} set={setPath} parts />
        <Text label="Horizon [h of operation]" hint="empty: until 95 % have failed" inputMode="decimal" value={horizon} set={setHorizon} />
        <Select label="Beside an earlier state of the design" value={state} set={setState} options={[["", "none"], ...past]} />
        <Check label="show 1 − R, logarithmic" value={log} set={setLog} />
      </div>
      {wrong && (
        <div className="trouble" role="alert">
          {wrong}
        </div>
      )}
      {found && <CurvePlots found={found} other={other} otherName="before" log={log} />}
    </>
  );
}
