import { type ReactNode, useState } from "react";
import { route, useShared } from "../lib/store";
import { ICONS } from "../parts/Icon";
import { Tabs } from "../parts/Tabs";
import { ImportParts } from "./parts/ImportParts";
import { OwnFormula } from "./parts/OwnFormula";
import { PartsTable } from "./parts/PartsTable";
import { UseLibrary } from "./parts/UseLibrary";

export const page = { name: "Parts", icon: ICONS.parts, order: 30 };

export default function Parts(): ReactNode {
  const { rest } = useShared(route);
  const [tab, setTab] = useState(["import", "library", "formula"].includes(rest) ? rest : "table");
  return (
    <>
      <div className="head">
        <h1>Parts</h1>
      </div>
      <Tabs label="Parts" chosen={tab} choose={setTab} tabs={[["table", "In this robot"], ["library", "Library of models"], ["formula", "Own formula"], ["import", "Import a parts list"]]} />
      {tab === "table" && <PartsTable />}
      {tab === "library" && <UseLibrary />}
      {tab === "formula" && <OwnFormula />}
      {tab === "import" && <ImportParts />}
    </>
  );
}
