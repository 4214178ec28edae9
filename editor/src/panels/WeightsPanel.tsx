import { asSentence } from "../app/sentence.ts";
import { set, setWeights } from "../commands/index.ts";
import type { Transform, WeightsKind } from "../model/settings.ts";
import { NumberField, Section, Segmented, Slider, Switch } from "./controls.tsx";
import { useApp, useAppState } from "./useStore.ts";

const KINDS: readonly { value: WeightsKind; label: string; title: string }[] = [
  { value: "neural", label: "Neural", title: "A network that is trained on the control points" },
  { value: "shape-aware", label: "Shape-aware", title: "A network that is trained on the shape too: parts side by side move apart" },
  { value: "inverse-distance", label: "Inverse distance", title: "1 / (d^(2 alpha) + epsilon), as in classic MLS" },
];

const MAPS: readonly { value: Transform; label: string; title: string }[] = [
  { value: "rigid", label: "Rigid", title: "Parts turn and move" },
  { value: "similarity", label: "Similarity", title: "Parts turn, move and grow or shrink" },
  { value: "affine", label: "Affine", title: "Parts stretch and shear too" },
];

export function WeightsPanel() {
  const app = useApp();
  const { settings } = useAppState().session;
  const { neural, "inverse-distance": inverse } = settings.weights;
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
      <Slider
        label="Relax"
        title="Above 0 the shape's own stiffness decides what control points leave open; 1: as far as it goes"
        value={settings.relax}
        min={0}
        max={1}
        closed
        onInput={(relax) => app.do(set("relax", relax))}
        onDone={seal}
      />
      {settings.kind === "inverse-distance" && (
        <>
          <Slider label="Alpha" title="How fast a control point's weight falls with the distance" value={inverse.alpha} min={0.25} max={6} onInput={(alpha) => app.do(setWeights("inverse-distance", { alpha }))} onDone={seal} />
          <Slider label="Epsilon" title="Above 0 no control point has all the weight at its place" value={inverse.epsilon} min={0} max={0.5} onInput={(epsilon) => app.do(setWeights("inverse-distance", { epsilon }))} onDone={seal} />
        </>
      )}
      {settings.kind === "neural" && (
        <div class="pair-of-fields">
          <label class="field" title="Neurons a hidden layer">
            <span>Width</span>
            <NumberField label="Width" value={neural.width} min={1} max={16384} whole onChange={(width) => app.do(setWeights("neural", { width }))} />
          </label>
          <label class="field" title="Where the network's random numbers start">
            <span>Seed</span>
            <NumberField label="Seed" value={neural.seed} min={0} max={Number.MAX_SAFE_INTEGER} whole onChange={(seed) => app.do(setWeights("neural", { seed }))} />
          </label>
        </div>
      )}
      <Segmented label="Local map" value={settings.transform} options={MAPS} onChange={(map) => app.do(set("transform", map))} />
      <Handles />
    </Section>
  );
}

/** Whether control points go near their targets, as in the paper, or all the way; and what comes of it. */
function Handles() {
  const app = useApp();
  const { session, report } = useAppState();
  const { handles } = session.settings;
  const take = (value: typeof handles) => app.do(set("handles", value));
  const seal = (): void => app.history.seal();
  return (
    <>
      <Switch
        label="Handles arrive"
        title="On: control points arrive at their targets; off: they go near them, as in the paper"
        on={handles !== "soft"}
        onChange={(on) => {
          take(on ? "auto" : "soft");
          seal();
        }}
      />
      {handles !== "soft" && (
        <Slider
          label="How closely"
          title="1: control points arrive; 0: they go near their targets, as in the paper"
          value={typeof handles === "number" ? handles : 1}
          min={0}
          max={1}
          closed
          onInput={(part) => take(part === 1 ? "auto" : part)}
          onDone={seal}
        />
      )}
      {(handles === "auto" || handles === "exact") && (
        <Switch
          label="Exact"
          title="On: they arrive whatever it does to the shape; off: all are left soft where one has too little weight of its own"
          on={handles === "exact"}
          onChange={(on) => {
            take(on ? "exact" : "auto");
            seal();
          }}
        />
      )}
      {report && (
        <div role="status">
          {report.soft !== null && <p class="hint">{asSentence(`${report.handles}: ${report.soft}`)}</p>}
          {report.warnings.map((warning) => (
            <p class="hint" key={warning}>{asSentence(warning)}</p>
          ))}
        </div>
      )}
    </>
  );
}
