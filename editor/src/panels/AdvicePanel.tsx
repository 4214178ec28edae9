import { asSentence } from "../app/sentence.ts";
import { select } from "../commands/index.ts";
import { Section } from "./controls.tsx";
import { useApp, useAppState } from "./useStore.ts";

/** What is likely bad about the shape as it is, and what would help; a click selects the control points that it is about. */
export function AdvicePanel() {
  const app = useApp();
  const { advice } = useAppState();
  if (advice.length === 0) return null;
  return (
    <Section title="Worth a look">
      <ul class="advice" role="status">
        {advice.map(({ kind, sentence, ids }) => (
          <li key={kind}>
            <button type="button" title="Select what it is about" onClick={() => app.do(select(ids))}>
              {asSentence(sentence)}
            </button>
          </li>
        ))}
      </ul>
    </Section>
  );
}
