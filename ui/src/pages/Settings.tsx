import type { ReactNode } from "react";
import { edit, prefer, preferences, useDesign, useShared } from "../lib/store";
import { change, isValues, treeOf } from "../lib/tree";
import { RATE_UNITS, type RateUnit } from "../lib/words";
import { Entry, Select } from "../parts/Field";
import { ICONS } from "../parts/Icon";
import { Changes } from "./settings/Changes";
import { OnlyFor } from "../parts/OnlyFor";

export const page = { name: "Settings", icon: ICONS.settings, order: 90 };

const THRESHOLDS: [string, string, string][] = [
  ["hazard_rate", "Hazard rate at most", "e.g. 1000 FPMH"],
  ["reliability", "Reliability at least", "since new, e.g. 0.9"],
  ["remaining_life", "Median remaining life at least", "e.g. 500 h"],
  ["completion", "Task completion at least", "e.g. 0.99"],
  ["survival", "State also the time until survival falls to", "e.g. 0.9"],
];

/** A limit alone, or the limit among what an alarm on it waits for. */
const limitOf = (stated: unknown): unknown => (isValues(stated) ? stated.limit : stated);

export default function Settings(): ReactNode {
  const shown = useShared(preferences);
  const design = useDesign();
  if (!design) return null;
  const root = treeOf(design);
  const thresholds = isValues(root.values.thresholds) ? root.values.thresholds : {};
  const number = (value: string): unknown => (value.trim() && Number.isFinite(Number(value)) ? Number(value) : value);
  return (
    <>
      <div className="head">
        <h1>Settings</h1>
      </div>
      <div className="two">
        <section className="card">
          <h2>This browser</h2>
          <Select label="Hazard rates in" value={shown.unit} set={(unit) => prefer({ unit: unit as RateUnit })} options={Object.entries(RATE_UNITS).map(([unit, { words }]): [string, string] => [unit, words])} />
          <Select label="Colours" value={shown.theme} set={(theme) => prefer({ theme: theme as "auto" | "light" | "dark" })} options={[["auto", "as the system has them"], ["light", "light"], ["dark", "dark"]]} />
          <Select label="Dates and times" value={shown.times} set={(times) => prefer({ times: times as "utc" | "local" })} options={[["utc", "UTC, as recordings and reports have them"], ["local", "local time of this browser"]]} />
        </section>
        <section className="card">
          <h2>Where health is no longer good enough</h2>
          <p className="small quiet">Part of the design; a breach shows as ERROR.</p>
          <div className="fields">
            <OnlyFor role="editor">
              {THRESHOLDS.map(([key, name, hint]) => (
                <Entry
                  key={key}
                  label={name}
                  hint={hint}
                  value={String(limitOf(thresholds[key]) ?? "")}
                  set={(value) => {
                    const place = isValues(thresholds[key]) ? ["thresholds", key, "limit"] : ["thresholds", key];
                    const operations = change(root, place, value === "" ? "" : ["hazard_rate", "remaining_life"].includes(key) ? value : number(value));
                    if (operations.length) void edit(operations, name);
                  }}
                />
              ))}
            </OnlyFor>
          </div>
        </section>
        <section className="card">
          <h2>When the robot is off</h2>
          <OnlyFor role="editor">
            <Entry
              label="Silent for so long, it is off"
              hint="default 60 s"
              value={String(root.values.max_gap ?? "")}
              set={(value) => {
                const operations = change(root, ["max_gap"], value);
                if (operations.length) void edit(operations, "Longest gap");
              }}
            />
          </OnlyFor>
        </section>
        <Changes />
        <section className="card">
          <h2>About</h2>
          <p>
            This page talks only to its own service at {location.host}; nothing is loaded from elsewhere. The design file is {design.file}, its edits (for undo) lie beside it in {design.file}.edits.
          </p>
          <p>
            It is built of the work of others, under <a href="./licenses.md">their licences</a>.
          </p>
        </section>
      </div>
    </>
  );
}
