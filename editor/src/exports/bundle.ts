/** What a page that is dragged offline holds: the shape as it is drawn, its weights and control points. Numbers in base64. */

import { Color, DoubleSide, type Material, MeshStandardMaterial, SRGBColorSpace, Texture } from "three";
import type { Box } from "../commands/index.ts";
import type { Constants } from "../model/handles.ts";
import type { Session } from "../model/session.ts";
import type { Drawn } from "../viewport/shapeView.ts";

export interface Bundle {
  title: string;
  box: Box;
  dim: 1 | 2 | 3;
  /** With the control points that the weights are for. */
  session: Session;
  logits: string;
  ownLogits: string;
  /** What takes the control points to their targets, and what the shader has of it. */
  core: string;
  constants: Constants;
  positions: string;
  normals: string;
  points: string;
  index: string | null;
  uv: string | null;
  colours: string | null;
  groups: Drawn["groups"];
  materials: PackedMaterial[];
}

/** What of a material is taken along. */
interface PackedMaterial {
  colour: string;
  roughness: number;
  metalness: number;
  opacity: number;
  vertexColours: boolean;
  /** A data URL. */
  texture: string | null;
}

type Numbers = Float32Array | Uint32Array | Uint8Array;

/** The bytes of numbers as text. Pieces that are divisible by three fit together. */
export function encode(numbers: Numbers): string {
  const bytes = new Uint8Array(numbers.buffer, numbers.byteOffset, numbers.byteLength);
  const pieces: string[] = [];
  for (let at = 0; at < bytes.length; at += 0x6000) {
    pieces.push(btoa(String.fromCharCode(...bytes.subarray(at, at + 0x6000))));
  }
  return pieces.join("");
}

function decode(text: string): ArrayBuffer {
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; i++) bytes[i] = binary.charCodeAt(i);
  return bytes.buffer;
}

/** A program as text, compressed. */
export async function pack(program: ArrayBuffer): Promise<string> {
  return encode(new Uint8Array(await through(program, new CompressionStream("gzip"))));
}

export const unpack = (text: string): Promise<ArrayBuffer> => through(decode(text), new DecompressionStream("gzip"));

const through = (bytes: ArrayBuffer, stream: CompressionStream | DecompressionStream): Promise<ArrayBuffer> =>
  new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer();

export const decodeFloats = (text: string): Float32Array<ArrayBuffer> => new Float32Array(decode(text));
export const decodeIndices = (text: string): Uint32Array<ArrayBuffer> => new Uint32Array(decode(text));

export function packMaterial(material: Material): PackedMaterial {
  const { color, roughness, metalness, map } = material as Partial<MeshStandardMaterial>;
  return {
    colour: (color ?? new Color(0xffffff)).getHexString(),
    roughness: roughness ?? 0.6,
    metalness: metalness ?? 0,
    opacity: material.opacity,
    vertexColours: material.vertexColors,
    texture: map ? pictureOf(map) : null,
  };
}

export function unpackMaterial(packed: PackedMaterial, redraw: () => void): MeshStandardMaterial {
  const { roughness, metalness, opacity, vertexColours, texture } = packed;
  const material = new MeshStandardMaterial({ roughness, metalness, opacity, transparent: opacity < 1, side: DoubleSide });
  material.color.set(`#${packed.colour}`);
  material.vertexColors = vertexColours;
  if (texture) {
    const image = new Image();
    const map = new Texture(image);
    map.colorSpace = SRGBColorSpace;
    // As it was packed: upside down already where it has to be.
    map.flipY = false;
    image.onload = () => {
      map.needsUpdate = true;
      redraw();
    };
    image.src = texture;
    material.map = map;
  }
  return material;
}

/** A texture as the graphics card has it. */
function pictureOf(map: Texture): string | null {
  const image = map.image as (CanvasImageSource & { width: number; height: number }) | undefined;
  if (!image?.width) return null;
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [image.width, image.height];
  const context = canvas.getContext("2d");
  if (!context) return null;
  if (map.flipY) {
    context.translate(0, image.height);
    context.scale(1, -1);
  }
  context.drawImage(image, 0, 0);
  return canvas.toDataURL();
}
