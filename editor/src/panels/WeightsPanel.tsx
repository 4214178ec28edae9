import { set, setClassic, setNeural } from "../commands/index.ts";
import type { Soft } from "../model/handles.ts";
import type { Transform, WeightsKind } from "../model/settings.ts";
import { distance, NumberField, Section, Segmented, short, Slider, Switch } from "./controls.tsx";
import { useApp, useAppState } from "./useStore.ts";

const KINDS: readonly { value: WeightsKind; label: string; title: string }[] = [
  { value: "neural", label: "Neural", title: "A network that is trained on the control points" },
  { value: "classic", label: "Classic", title: "Inverse distance, 1 / (d^(2 alpha) + epsilon)" },
];

const MAPS: readonly { value: Transform; label: string; title: string }[] = [
  { value: "rigid", label: "Rigid", title: "Parts turn and move" },
  { value: "similarity", label: "Similarity", title: "Parts turn, move and grow or shrink" },
  { value: "affine", label: "Affine", title: "Parts stretch and shear too" },
];

export function WeightsPanel() {
  const app = useApp();
  const { settings } = useAppState().session;
  const seal = (): void => app.history.seal();
  return (
    <Section title="Weights">
      <Segmented label="Weight function" value={settings.kind} options={KINDS} onChange={(kind) => app.do(set("kind", kind))} />
      <Slider
        label="Temperature"
        title="Lower: parts move more apart from each other; higher: more together"
        value={settings.temperature}
        min={0.05}
        max={10}
        logarithmic
        onInput={(value) => app.do(set("temperature", value))}
        onDone={seal}
      />
      {settings.kind === "classic" ? (
        <>
          <Slider label="Alpha" title="How fast a control point's weight falls with the distance" value={settings.classic.alpha} min={0.25} max={6} onInput={(alpha) => app.do(setClassic({ alpha }))} onDone={seal} />
          <Slider label="Epsilon" title="Above 0 no control point has all the weight at its place" value={settings.classic.epsilon} min={0} max={0.5} onInput={(epsilon) => app.do(setClassic({ epsilon }))} onDone={seal} />
        </>
      ) : (
        <div class="pair-of-fields">
          <label class="field" title="Neurons a hidden layer">
            <span>Width</span>
            <NumberField label="Width" value={settings.neural.width} min={1} max={16384} whole onChange={(width) => app.do(setNeural({ width }))} />
          </label>
          <label class="field" title="Where the network's random numbers start">
            <span>Seed</span>
            <NumberField label="Seed" value={settings.neural.seed} min={0} max={Number.MAX_SAFE_INTEGER} whole onChange={(seed) => app.do(setNeural({ seed }))} />
          </label>
        </div>
      )}
      <Segmented label="Local map" value={settings.transform} options={MAPS} onChange={(map) => app.do(set("transform", map))} />
      <ExactHandles />
    </Section>
  );
}

/** Whether control points go near their targets, as in the paper, or all the way. */
function ExactHandles() {
  const app = useApp();
  const { session, soft, shape } = useAppState();
  const { adherence } = session.settings;
  const take = (value: number) => app.do(set("adherence", value));
  return (
    <>
      <Switch
        label="Exact handles"
        title="On: control points arrive at their targets; off: they go near them, as in the paper"
        on={adherence > 0}
        onChange={(on) => {
          take(on ? 1 : 0);
          app.history.seal();
        }}
      />
      {adherence > 0 && (
        <Slider label="Adherence" title="1: control points arrive; 0: they go near their targets, as in the paper" value={adherence} min={0} max={1} closed onInput={take} onDone={() => app.history.seal()} />
      )}
      {soft && shape && (
        <p class="hint" role="status">
          {whySoft(soft, session.points.find(({ id }) => id === soft.id)?.name ?? "one", 2 * shape.opened.frame.half)}
        </p>
      )}
    </>
  );
}

function whySoft({ reason, amount, remedy }: Soft, name: string, size: number): string {
  const why =
    reason === "shared"
      ? `Left soft: ${name} has only ${amount.toPrecision(2)} of the weight at its own place`
      : `${name} stays ${distance(amount, size)} off`;
  const help = remedy === null ? "" : remedy === "affine" ? " The affine map takes them there." : ` At temperature ${short(remedy)} they arrive.`;
  return `${why}.${help}`;
}
