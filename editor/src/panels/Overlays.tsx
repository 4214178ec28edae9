import { useEffect, useRef } from "preact/hooks";
import { otherKind, type WeightsKind } from "../model/settings.ts";
import { GESTURES, SHORTCUTS } from "./actions.ts";
import { Button } from "./controls.tsx";
import { Icon } from "./icons.tsx";
import { toldOf } from "./told.ts";
import { useApp, useAppState } from "./useStore.ts";

/** What is seen before there is a shape. */
export function Empty() {
  const app = useApp();
  const { shape, samples, recent, busy } = useAppState();
  if (shape || busy) return null;
  return (
    <div class="empty">
      <div class="card">
        <svg class="drop-picture" viewBox="0 0 120 80" aria-hidden="true">
          <path d="M10 62C30 8 52 10 60 40s30 30 50-24" />
          <circle cx="10" cy="62" r="6" />
          <circle cx="60" cy="40" r="6" class="middle" />
          <circle cx="110" cy="16" r="6" />
        </svg>
        <h2>Drop a shape here</h2>
        <p>
          OBJ, PLY, OFF, STL, glTF, GLB, XYZ, CSV or NPY, with its materials and textures.
          <br />
          It stays in your browser: nothing is uploaded.
        </p>
        <Button primary icon="open" label="Open a file" onClick={() => document.getElementById("open-files")?.click()} />
        {samples.length > 0 && (
          <div class="samples">
            <span>or try</span>
            {samples.map((sample) => (
              <button type="button" class="button" key={sample.name} onClick={() => void app.openSample(sample)}>
                {sample.title}
              </button>
            ))}
          </div>
        )}
        {recent.length > 0 && (
          <section class="recent" aria-labelledby="recent-title">
            <h3 id="recent-title">Your work</h3>
            <ul>
              {recent.map((work) => (
                <li key={work.id}>
                  <button type="button" class="work-card" onClick={() => void app.takeUp(work.id)}>
                    {work.picture ? <img src={work.picture} alt="" /> : <Icon name="target" />}
                    <strong>{work.name}</strong>
                    <small>{toldOf(work)}</small>
                  </button>
                  <Button quiet icon="close" label={`Forget ${work.name}`} onClick={() => void app.forget(work.id)} />
                </li>
              ))}
            </ul>
          </section>
        )}
      </div>
    </div>
  );
}

/** Work on the shape that was opened by `neuralmls edit`. */
export function Offer() {
  const app = useApp();
  const { offer } = useAppState();
  if (!offer) return null;
  return (
    <div class="offer" role="status">
      <span>
        You have worked on <strong>{offer.name}</strong> before: {toldOf(offer)}.
      </span>
      <Button primary label="Take it up again" onClick={() => void app.takeUp(offer.id)} />
      <Button label="Begin anew" onClick={() => app.store.set({ offer: null })} />
    </div>
  );
}

export function BusyNote() {
  const { busy } = useAppState();
  if (!busy) return null;
  const percent = busy.fraction === null ? undefined : Math.round(100 * busy.fraction);
  return (
    <div class="busy" role="status">
      <span>{busy.label}</span>
      <progress max="100" value={percent} aria-label={busy.label} />
      {busy.cancel && <Button quiet icon="close" label="Cancel" onClick={busy.cancel} />}
    </div>
  );
}

export function Toasts() {
  const app = useApp();
  const { toasts } = useAppState();
  return (
    <div class="toasts" aria-live="polite">
      {toasts.map((toast) => (
        <div key={toast.id} class={`toast ${toast.kind}`} role={toast.kind === "error" ? "alert" : "status"}>
          <span>{toast.text}</span>
          {toast.action && <Button label={toast.action.label} onClick={toast.action.run} />}
          <Button quiet icon="close" label="Dismiss" onClick={() => app.dismiss(toast.id)} />
        </div>
      ))}
    </div>
  );
}

/** The two kinds of weights, named above their halves. */
export function SideLabels() {
  const { view, session, comparisonFit } = useAppState();
  if (!view.comparison) return null;
  const { kind } = session.settings;
  const name = (kind: WeightsKind): string => kind[0].toUpperCase() + kind.slice(1).replace("-", " ");
  return (
    <div class="side-labels" aria-hidden="true">
      <span>{name(kind)}</span>
      <span>
        {name(otherKind(kind))}
        {comparisonFit.status === "fitting" ? " …" : ""}
      </span>
    </div>
  );
}

export function Help() {
  const app = useApp();
  const { help } = useAppState();
  const dialog = useRef<HTMLDialogElement>(null);
  useEffect(() => {
    if (help) dialog.current?.showModal();
    else dialog.current?.close();
  }, [help]);
  const groups = ["Edit", "Move", "View", "File"] as const;
  return (
    <dialog ref={dialog} class="help" aria-labelledby="help-title" onClose={() => app.store.set({ help: false })} onClick={(event) => event.target === dialog.current && app.store.set({ help: false })}>
      <header>
        <h2 id="help-title">Keys and gestures</h2>
        <Button quiet icon="close" label="Close" hint="Esc" onClick={() => app.store.set({ help: false })} />
      </header>
      <div class="help-columns">
        <section>
          <h3>On the shape</h3>
          <dl>{GESTURES.map(([keys, what]) => <Entry key={keys} keys={keys} what={what} />)}</dl>
        </section>
        {groups.map((group) => (
          <section key={group}>
            <h3>{group}</h3>
            <dl>
              {SHORTCUTS.filter((shortcut) => shortcut.group === group).map((s) => <Entry key={s.keys} keys={s.keys} what={s.label} />)}
            </dl>
          </section>
        ))}
      </div>
      <footer>
        <Icon name="target" />
        <span>
          A small network, trained on nothing but your control points, says how much each matters where; moving least squares turns that
          into a motion. Low temperatures keep parts apart.
        </span>
      </footer>
    </dialog>
  );
}

function Entry({ keys, what }: { keys: string; what: string }) {
  return (
    <>
      <dt><kbd>{keys}</kbd></dt>
      <dd>{what}</dd>
    </>
  );
}
