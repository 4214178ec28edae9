import type { State } from "../app/state.ts";
import { select } from "../commands/index.ts";
import { Section, short } from "./controls.tsx";
import { useApp, useAppState } from "./useStore.ts";

/** What is likely bad about the shape as it is, and what would help; a click selects the control points that it is about. */
export function AdvicePanel() {
  const app = useApp();
  const { advice, session } = useAppState();
  if (advice.length === 0) return null;
  const nameOf = (id: number | undefined): string => session.points.find((point) => point.id === id)?.name ?? "one that is gone";
  return (
    <Section title="Worth a look">
      <ul class="advice" role="status">
        {advice.map((one) => (
          <li key={one.kind}>
            <button type="button" title="Select what it is about" onClick={() => app.do(select([...new Set(one.ids)]))}>
              {sentence(one, one.ids.map(nameOf))}
            </button>
          </li>
        ))}
      </ul>
    </Section>
  );
}

function sentence({ kind, amount, better, left }: State["advice"][number], [first, second]: string[]): string {
  const how = better === "soft" ? "Without exact handles" : better === null ? null : `At temperature ${short(better)}`;
  const help = (otherwise: string): string => (how === null ? otherwise : `${how} it is ${percent(left)}.`);
  switch (kind) {
    case "folds":
      return `${percent(amount)} of the shape is folded over, most of all near ${first}. ${help("Move the control points there less far towards or past each other.")}`;
    case "torn":
      return `Torn between ${first} and ${second}, stretched up to ${amount.toFixed(0)} times. ${help("Move them less far apart, or put control points between them.")}`;
    case "ungoverned":
      return `A part moves that no control point governs: the nearest, ${first}, is ${amount.toFixed(1)} times as far away as they are from each other. Put one there.`;
  }
}

const percent = (part: number): string => `${Number((100 * part).toPrecision(2))} %`;
