/** What the core says, with a capital and a full stop; not where it begins with the name of a file. */
export function asSentence(text: string): string {
  const capital = /^[a-z]+[ :',]/.test(text) && !/^\S+\.\w+:/.test(text) ? text[0].toUpperCase() + text.slice(1) : text;
  return /[.!?]$/.test(capital) ? capital : `${capital}.`;
}
