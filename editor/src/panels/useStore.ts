import { createContext } from "preact";
import { useContext, useEffect, useState } from "preact/hooks";
import type { App } from "../app/app.ts";
import type { State } from "../app/state.ts";

export const AppContext = createContext<App | null>(null);

export function useApp(): App {
  const app = useContext(AppContext);
  if (!app) throw new Error("a panel outside of the application");
  return app;
}

/** What the panels show; they are drawn again when it changes. */
export function useAppState(): State {
  const { store } = useApp();
  const [state, setState] = useState(store.value);
  useEffect(() => {
    setState(store.value);
    return store.subscribe(setState);
  }, [store]);
  return state;
}
