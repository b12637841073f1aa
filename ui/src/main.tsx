import { StrictMode } from "react";
import { createRoot } from "react-dom/client";
import { App } from "./app";
import { live } from "./lib/live";
import { applyPreferences, refresh } from "./lib/store";
import "./style.css";

applyPreferences();
void refresh();
live.connect();
const show = location.pathname.endsWith("/wall") ? import("./Wall").then((found) => found.default) : Promise.resolve(App);
void show.then((Shown) =>
  createRoot(document.getElementById("page")!).render(
    <StrictMode>
      <Shown />
    </StrictMode>,
  ),
);
