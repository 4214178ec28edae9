/** What `neuralmls edit` opened: the page's address then ends in `?session` (python/neuralmls/editor_server). */

import { CoreError, type Files } from "./protocol.ts";

export interface Served {
  files: Files;
  /** The shape's name, a key of `files`. */
  name: string;
  /** A file of control points or of a session; not among `files`, where one may have the same name. */
  points: readonly [string, Uint8Array] | null;
}

interface Listed {
  name: string;
  address: string;
}

/** The session of the server that this page came from; null where there is none. */
export async function servedSession(): Promise<Served | null> {
  if (!new URLSearchParams(location.search).has("session")) return null;
  const { shape, files, points }: { shape: string; files: Listed[]; points: Listed | null } = await (
    await got("session.json")
  ).json();
  const bytes = async ({ name, address }: Listed) =>
    [name, new Uint8Array(await (await got(address)).arrayBuffer())] as const;
  return { files: new Map(await Promise.all(files.map(bytes))), name: shape, points: points && (await bytes(points)) };
}

async function got(address: string): Promise<Response> {
  const response = await fetch(address).catch(() => null);
  if (!response?.ok) throw new CoreError("the shape could not be fetched: is neuralmls edit still running?");
  return response;
}
