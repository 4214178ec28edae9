export async function page(..._: unknown[]): Promise<string> {
  throw new Error("not yet");
}
