/**
 * Materials, textures and colours of a file, as three's loaders read them. The shape itself is that of the core: what a loader brings
 * is hung on its triangles, corner by corner, if both agree on all of them; else the shape is shown plain.
 */

import { Color, DoubleSide, LoadingManager, type Material, Mesh, MeshPhongMaterial, MeshStandardMaterial, type Object3D, Vector3 } from "three";
import type { OpenedShape } from "./openedShape.ts";
import type { CornerData } from "./restVertices.ts";

/** What a file looks like besides its form. */
export interface Appearance {
  /** For each corner of each triangle. */
  uv?: CornerData;
  colours?: CornerData;
  groups: { start: number; count: number; material: number }[];
  materials: Material[];
}

type Files = ReadonlyMap<string, Uint8Array>;

/** Larger files are shown plain: the loaders would hold up the page. */
const LARGEST_TEXT = 40e6;
/** Where a PLY file's header ends at the latest, in bytes. */
const LONGEST_HEADER = 1e5;
/** Largest difference between the loader's places and the core's, relative to the shape's box. */
const TOLERANCE = 1e-3;

/** Undefined where a file has none, or none that can be shown. */
export async function appearanceOf(opened: OpenedShape, files: Files): Promise<Appearance | undefined> {
  const bytes = files.get(opened.name);
  if (!bytes || !opened.triangles) return undefined;
  const manager = new BlobManager(files);
  try {
    if (opened.format === "OBJ" && bytes.length < LARGEST_TEXT) return await objAppearance(opened, bytes, files, manager);
    if (opened.format === "GLB" || opened.format === "glTF") return await gltfAppearance(opened, bytes, manager);
    return undefined;
  } catch {
    // The core has read the shape; that three cannot show its materials hinders nothing.
    return undefined;
  } finally {
    await manager.settled();
    manager.revoke();
  }
}

/** The colours of a PLY file's points, n x 3, linear. */
export async function pointColours(opened: OpenedShape, files: Files): Promise<Float32Array<ArrayBuffer> | undefined> {
  const bytes = files.get(opened.name);
  if (!bytes || opened.format !== "PLY") return undefined;
  const header = new TextDecoder("latin1").decode(bytes.subarray(0, LONGEST_HEADER)).split("end_header")[0];
  if (!/^property \S+ (red|diffuse_red|f_dc_0)\s*$/m.test(header)) return undefined;
  const { PLYLoader } = await import("three/addons/loaders/PLYLoader.js");
  const loader = new PLYLoader();
  if (header.includes("f_dc_0")) loader.setCustomPropertyNameMapping({ harmonics: ["f_dc_0", "f_dc_1", "f_dc_2"] });
  try {
    const geometry = loader.parse(bytes.slice().buffer);
    const count = opened.positions.length;
    const colour = geometry.getAttribute("color");
    // By its own account of them: bytes count as parts of the largest.
    if (colour?.array.length === count) {
      return Float32Array.from({ length: count }, (_, at) => colour.getComponent(Math.floor(at / 3), at % 3));
    }
    const harmonics = geometry.getAttribute("harmonics");
    if (harmonics?.array.length !== count) return undefined;
    // The constant term of spherical harmonics, as 3D Gaussian splats have it, in sRGB.
    const colours = Float32Array.from(harmonics.array, (f) => Math.min(1, Math.max(0, 0.5 + 0.28209479 * f)));
    const scratch = new Color();
    for (let i = 0; i < count; i += 3) {
      scratch.setRGB(colours[i], colours[i + 1], colours[i + 2], "srgb").toArray(colours, i);
    }
    return colours;
  } catch {
    return undefined;
  }
}

async function objAppearance(opened: OpenedShape, bytes: Uint8Array, files: Files, manager: BlobManager) {
  const [{ OBJLoader }, { MTLLoader }] = await Promise.all([
    import("three/addons/loaders/OBJLoader.js"),
    import("three/addons/loaders/MTLLoader.js"),
  ]);
  const decode = (data: Uint8Array): string => new TextDecoder().decode(data);
  const libraries = [...files].filter(([name]) => name.toLowerCase().endsWith(".mtl"));
  const loader = new OBJLoader(manager);
  if (libraries.length > 0) {
    const creator = new MTLLoader(manager).parse(libraries.map(([, data]) => decode(data)).join("\n"), "");
    creator.preload();
    loader.setMaterials(creator);
  }
  const meshes = loader.parse(decode(bytes)).children.filter((node): node is Mesh => node instanceof Mesh);
  const coloured = meshes.some((mesh) => mesh.geometry.hasAttribute("color"));
  return libraries.length > 0 || coloured ? collect(opened, meshes) : undefined;
}

async function gltfAppearance(opened: OpenedShape, bytes: Uint8Array, manager: BlobManager) {
  const { GLTFLoader } = await import("three/addons/loaders/GLTFLoader.js");
  const { scenes, parser } = await new GLTFLoader(manager).parseAsync(bytes.slice().buffer, "");
  const found: { mesh: Mesh; node: number; primitive: number }[] = [];
  for (const scene of scenes) {
    scene.updateMatrixWorld(true);
    scene.traverse((object) => {
      if (!(object instanceof Mesh)) return;
      const { primitives } = parser.associations.get(object) ?? {};
      const node = nodeOf(object, parser.associations);
      if (node !== undefined) found.push({ mesh: object, node, primitive: primitives ?? 0 });
    });
  }
  // In the core's order: by node, then by primitive.
  found.sort((a, b) => a.node - b.node || a.primitive - b.primitive);
  return collect(opened, found.map(({ mesh }) => mesh));
}

function nodeOf(object: Object3D, associations: Map<object, { nodes?: number }>): number | undefined {
  for (let at: Object3D | null = object; at; at = at.parent) {
    const { nodes } = associations.get(at) ?? {};
    if (nodes !== undefined) return nodes;
  }
  return undefined;
}

/** What meshes bring, in the order of the core's corners; undefined where they are not the same corners. */
function collect(opened: OpenedShape, meshes: readonly Mesh[]): Appearance | undefined {
  const triangles = opened.triangles as Uint32Array;
  const size = (mesh: Mesh): number => mesh.geometry.index?.count ?? mesh.geometry.getAttribute("position").count;
  if (meshes.reduce((sum, mesh) => sum + size(mesh), 0) !== triangles.length) return undefined;
  const has = (name: string): boolean => meshes.some((mesh) => mesh.geometry.hasAttribute(name));
  const uv = has("uv") ? { data: new Float32Array(2 * triangles.length), size: 2 } : undefined;
  const colours = has("color") ? { data: new Float32Array(3 * triangles.length).fill(1), size: 3 } : undefined;
  const materials: Material[] = [];
  const groups: Appearance["groups"] = [];
  const place = new Vector3();
  let at = 0;
  for (const mesh of meshes) {
    const { index, groups: own } = mesh.geometry;
    const [uvs, tints] = ["uv", "color"].map((name) => mesh.geometry.getAttribute(name));
    const used = Array.isArray(mesh.material) ? mesh.material : [mesh.material];
    const first = materials.length;
    for (const material of used) materials.push(Object.assign(physical(material), { side: DoubleSide }));
    const parts = own.length > 0 && Array.isArray(mesh.material) ? own : [{ start: 0, count: size(mesh), materialIndex: 0 }];
    for (const { start, count, materialIndex } of parts) {
      groups.push({ start: at + start, count, material: first + (materialIndex ?? 0) });
    }
    for (let corner = 0; corner < size(mesh); corner++, at++) {
      const vertex = index ? index.getX(corner) : corner;
      mesh.getVertexPosition(vertex, place).applyMatrix4(mesh.matrixWorld);
      if (!opened.isAt(triangles[at], place, TOLERANCE)) return undefined;
      if (uv && uvs) uv.data.set([uvs.getX(vertex), uvs.getY(vertex)], 2 * at);
      if (colours && tints) colours.data.set([tints.getX(vertex), tints.getY(vertex), tints.getZ(vertex)], 3 * at);
    }
  }
  return { ...(uv && { uv }), ...(colours && { colours }), groups, materials };
}

/** MTL files tell of gloss as Phong did; the same in terms of roughness, as all else is shown, and as GLB files have it. */
function physical(material: Material): Material {
  if (!(material instanceof MeshPhongMaterial)) return material;
  const { name, color, map, normalMap, alphaMap, opacity, transparent, vertexColors, shininess } = material;
  const roughness = Math.sqrt(2 / (2 + shininess));
  const maps = { map, normalMap, alphaMap };
  return new MeshStandardMaterial({ name, color, ...maps, opacity, transparent, vertexColors, roughness, metalness: 0 });
}

/** Gives three's loaders the files that were opened together, and nothing else. */
class BlobManager extends LoadingManager {
  readonly #urls: string[] = [];
  #loading = 0;
  #settle: () => void = () => {};

  constructor(files: Files) {
    super();
    const known = new Map([...files].map(([name, data]) => [name.toLowerCase(), data]));
    const base = (path: string): string => decodeURIComponent(path.split(/[\\/]/).at(-1) ?? path).toLowerCase();
    this.setURLModifier((url) => {
      if (url.startsWith("blob:") || url.startsWith("data:")) return url;
      const data = known.get(url.toLowerCase()) ?? known.get(base(url));
      const made = URL.createObjectURL(new Blob(data ? [data.slice()] : []));
      this.#urls.push(made);
      return made;
    });
    const [start, end] = [this.itemStart, this.itemEnd];
    this.itemStart = (url) => {
      this.#loading++;
      start.call(this, url);
    };
    this.itemEnd = (url) => {
      end.call(this, url);
      if (--this.#loading === 0) this.#settle();
    };
  }

  /** Resolves when no texture is on its way. */
  async settled(): Promise<void> {
    if (this.#loading > 0) await new Promise<void>((resolve) => (this.#settle = resolve));
  }

  revoke(): void {
    for (const url of this.#urls) URL.revokeObjectURL(url);
  }
}
