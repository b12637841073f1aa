import { StrictMode } from "react";
import { createRoot } from "react-dom/client";
import { App } from "./app";
import { live } from "./lib/live";
import { applyTheme, refresh } from "./lib/store";
import "./style.css";

applyTheme();
void refresh();
live.connect();
createRoot(document.getElementById("page")!).render(
  <StrictMode>
    <App />
  </StrictMode>,
);
