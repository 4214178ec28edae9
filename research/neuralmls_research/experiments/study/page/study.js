"use strict";
// A participant's state is their seed and their choices; everything that they see follows from it and the study.
// Results have numbers only: which method made which is in `study.key`, which goes into the answers unread.

const FORMAT = "neuralmls-study-answers-1";
const study = JSON.parse(document.getElementById("study").textContent);
const one = (selector) => document.querySelector(selector);
const all = (selector) => [...document.querySelectorAll(selector)];

const touched = matchMedia("(pointer: coarse)").matches; // a tablet: no word about keys, which work all the same
const givenSeed = /(?:^#|&)seed=(\d+)(?:&|$)/.exec(location.hash);
const storageName = `neuralmls-study-${study.id}${givenSeed ? `-${givenSeed[1]}` : ""}`;

let state = stored() ?? newcomer();
let sequence = order(state.seed);
let at = firstUnanswered(); // the question that is shown, by its place in the sequence

// The order of questions and results

/** Random numbers in [0, 1) from a 32-bit seed: a Weyl sequence through the mixer of MurmurHash3. */
function random(seed) {
  let counter = seed >>> 0;
  return () => {
    counter = (counter + 0x9e3779b9) >>> 0;
    let mixed = Math.imul(counter ^ (counter >>> 16), 0x85ebca6b);
    mixed = Math.imul(mixed ^ (mixed >>> 13), 0xc2b2ae35);
    return ((mixed ^ (mixed >>> 16)) >>> 0) / 2 ** 32;
  };
}

function shuffled(items, draw) {
  const out = [...items];
  for (let last = out.length - 1; last > 0; last--) {
    const other = Math.floor(draw() * (last + 1));
    [out[last], out[other]] = [out[other], out[last]];
  }
  return out;
}

/** The questions as a participant sees them, each with the numbers of its results in their order. */
function order(seed) {
  const draw = random(seed);
  const questions = shuffled(study.questions, draw);
  return questions.map((question) => ({ ...question, order: shuffled(question.results.keys(), draw) }));
}

// The participant

function newcomer() {
  const [seed, ...name] = crypto.getRandomValues(new Uint32Array(5));
  const participant = name.map((word) => word.toString(16).padStart(8, "0")).join("");
  return { participant, seed: givenSeed ? Number(givenSeed[1]) >>> 0 : seed, begun: false, choices: {} };
}

function stored() {
  try {
    const found = JSON.parse(localStorage.getItem(storageName));
    return found?.participant && found.choices ? found : null;
  } catch {
    return null; // storage is switched off, or what is there is broken
  }
}

function keep() {
  try {
    localStorage.setItem(storageName, JSON.stringify(state));
  } catch {
    say("This browser does not keep your answers: save them as a file before you close the page.");
  }
}

function answered(question) {
  return state.choices[question.id] !== undefined;
}

function firstUnanswered() {
  const place = sequence.findIndex((question) => !answered(question));
  return place < 0 ? sequence.length : place;
}

/** The file that a participant saves. */
function answers() {
  const given = sequence.filter(answered);
  return {
    format: FORMAT, study: study.id, key: study.key, participant: state.participant, seed: state.seed,
    questions: sequence.length,
    answers: given.map(({ id, order }) => ({ question: id, order, choice: state.choices[id] })),
  };
}

function save() {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([JSON.stringify(answers(), null, 1)], { type: "application/json" }));
  link.download = `study-answers-${state.participant.slice(0, 8)}.json`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  say(`Saved as ${link.download}, where this browser puts downloads.`);
}

async function load(file) {
  let found;
  try {
    found = JSON.parse(await file.text());
  } catch {
    found = null;
  }
  if (found?.format !== FORMAT || !Array.isArray(found.answers)) return say(`${file.name} holds no answers to a study.`);
  if (found.study !== study.id) return say(`${file.name} holds answers to another study than this one.`);
  const choices = {};
  for (const { question, choice } of found.answers) {
    const asked = study.questions.find(({ id }) => id === question);
    if (!asked || !(choice in asked.results)) return say(`${file.name} is damaged: it answers what was not asked.`);
    choices[question] = choice;
  }
  state = { participant: String(found.participant), seed: Number(found.seed) >>> 0, begun: true, choices };
  sequence = order(state.seed);
  at = firstUnanswered();
  keep();
  show();
  return undefined;
}

// What is seen

let silence;
function say(text) {
  clearTimeout(silence);
  one("#message").textContent = text;
  silence = setTimeout(() => (one("#message").textContent = ""), 6000);
}

function show() {
  const screen = !state.begun ? "welcome" : at < sequence.length ? "question" : "end";
  for (const main of all("main")) main.hidden = main.id !== screen;
  if (screen === "question") showQuestion();
  one(`#${screen} h1`).focus({ preventScroll: true });
  scrollTo(0, 0);
}

function showQuestion() {
  const question = sequence[at];
  one("#number").textContent = `Question ${at + 1} of ${sequence.length}`;
  one("#source img").src = question.source;
  const count = question.order.length;
  one("#stage").dataset.count = count;
  one("#results").replaceChildren(...question.order.map((result, place) => resultButton(question, result, place, count)));
  one("#back").disabled = at === 0;
  showChoice();
}

function resultButton(question, result, place, count) {
  const button = document.createElement("button");
  button.type = "button";
  button.className = "result";
  const picture = document.createElement("img");
  picture.src = question.results[result];
  picture.alt = `Result ${place + 1} of ${count}`;
  const badge = document.createElement("span");
  badge.className = "badge";
  badge.ariaHidden = "true";
  badge.textContent = place + 1;
  button.append(picture, badge);
  button.addEventListener("click", () => choose(place));
  return button;
}

function showChoice() {
  const question = sequence[at];
  const chosen = state.choices[question.id];
  all(".result").forEach((button, place) => {
    button.ariaPressed = String(question.order[place] === chosen);
  });
  const done = sequence.filter(answered).length;
  one("#progress").max = sequence.length;
  one("#progress").value = done;
  one("#next").ariaDisabled = String(chosen === undefined);
  one("#next").textContent = at + 1 < sequence.length ? "Next →" : "Finish →";
  one("#hint").textContent = chosen === undefined
    ? touched ? "Touch the picture that you choose" : `Choose with the keys 1 to ${question.order.length}, or click a picture`
    : `${touched ? "Next" : "Enter"} goes on; you may still change your choice`;
}

// What is done

function choose(place) {
  const question = sequence[at];
  if (place >= question.order.length) return;
  state.choices[question.id] = question.order[place];
  keep();
  showChoice();
  all(".result")[place].focus({ preventScroll: true });
}

function begin() {
  state.begun = true;
  keep();
  show();
}

function forward() {
  if (at >= sequence.length) return;
  if (!answered(sequence[at])) return say("Please choose a picture first.");
  at += 1;
  show();
  return undefined;
}

function backward() {
  if (at === 0) return;
  at -= 1;
  show();
}

function pressed(event) {
  if (event.ctrlKey || event.altKey || event.metaKey || event.repeat) return;
  const digit = /^[1-9]$/.test(event.key) ? Number(event.key) : 0;
  const onButton = event.target instanceof HTMLButtonElement;
  const onChosen = onButton && event.target.ariaPressed === "true";
  if (!state.begun) {
    if (event.key !== "Enter" || onButton) return;
    begin();
  } else if (digit && at < sequence.length) choose(digit - 1);
  else if (event.key === "ArrowLeft") backward();
  else if (event.key === "ArrowRight") forward();
  else if (event.key === "Enter" && (!onButton || onChosen)) forward();
  else return; // a button does by itself what it does
  event.preventDefault();
}

one("#count").textContent = study.questions.length === 1 ? "one question" : `${study.questions.length} questions`;
one("#begin").addEventListener("click", begin);
one("#next").addEventListener("click", forward);
one("#back").addEventListener("click", backward);
one("#review").addEventListener("click", backward);
one("#again").addEventListener("click", () => {
  if (!confirm("Have you saved your answers? They are removed from this browser.")) return;
  state = newcomer();
  sequence = order(state.seed);
  at = 0;
  keep();
  show();
});
for (const button of all(".save")) button.addEventListener("click", save);
for (const button of all(".load")) button.addEventListener("click", () => one("#file").click());
one("#file").addEventListener("change", async ({ target }) => {
  if (target.files.length) await load(target.files[0]);
  target.value = "";
});
document.addEventListener("keydown", pressed);
show();
