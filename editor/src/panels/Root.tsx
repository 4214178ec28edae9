import { useEffect, useRef } from "preact/hooks";
import type { App } from "../app/app.ts";
import { ACCEPTED } from "../app/files.ts";
import { AdvicePanel } from "./AdvicePanel.tsx";
import { LookBar } from "./LookBar.tsx";
import { BusyNote, Empty, Help, Offer, SideLabels, Toasts } from "./Overlays.tsx";
import { PointsPanel } from "./PointsPanel.tsx";
import { StatusBar } from "./StatusBar.tsx";
import { ToolBar } from "./ToolBar.tsx";
import { TopBar } from "./TopBar.tsx";
import { AppContext, useApp, useAppState } from "./useStore.ts";
import { WeightsPanel } from "./WeightsPanel.tsx";

/** The whole page; `host` is the element that the view of the shape draws into. */
export function Root({ app, host }: { app: App; host: HTMLElement }) {
  return (
    <AppContext.Provider value={app}>
      <Page host={host} />
    </AppContext.Provider>
  );
}

function Page({ host }: { host: HTMLElement }) {
  const app = useApp();
  const { shape, theme } = useAppState();
  const view = useRef<HTMLDivElement>(null);
  useEffect(() => view.current?.prepend(host), [host]);
  useEffect(() => {
    document.documentElement.dataset.theme = theme;
  }, [theme]);
  return (
    <div class="page">
      <TopBar />
      <input
        id="open-files"
        class="visually-hidden"
        type="file"
        multiple
        tabIndex={-1}
        accept={ACCEPTED}
        onChange={(event) => {
          const { files } = event.currentTarget;
          if (files) void app.openFiles([...files]);
          event.currentTarget.value = "";
        }}
      />
      <main class="work" aria-label="Shape">
        <div class="view" ref={view}>
          <SideLabels />
          <ToolBar />
          <LookBar />
          <Empty />
          <Offer />
          <BusyNote />
          <StatusBar />
        </div>
        {shape && (
          <aside class="panel" aria-label="Settings">
            <PointsPanel />
            <WeightsPanel />
            <AdvicePanel />
          </aside>
        )}
      </main>
      <Toasts />
      <Help />
    </div>
  );
}
