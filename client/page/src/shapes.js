// The shapes of scene files as three.js objects.
//
// Points of a scene have one to three numbers; those that lack are 0. Along an axis that the device lacks, what it feels
// has no extent, and is drawn with some. An object's origin is where `moved` messages place it: the middle of the shape.
import {
  BackSide, BoxGeometry, BufferAttribute, BufferGeometry, CapsuleGeometry, CylinderGeometry, DoubleSide, FrontSide,
  Group, LatheGeometry, LineSegments, Mesh, Quaternion, SphereGeometry, TorusGeometry, Vector2, Vector3,
} from "three";

const kUp = new Vector3(0, 1, 0); // axis of three.js's cylinders and capsules
const kForward = new Vector3(0, 0, 1); // axis of its torus

/** @returns {Vector3} a point of a scene of one to three axes */
export function point(numbers) {
  const [x = 0, y = 0, z = 0] = numbers ?? [];
  return new Vector3(x, y, z);
}

/** The size of a block, with some where the device has no axis or the block no end (null). */
function blockSize(size_m, dof, thick_m, endless_m) {
  return [0, 1, 2].map((axis) => (axis < dof ? size_m[axis] ?? endless_m : thick_m));
}

const kinds = {
  half_space(shape, { radius_m, around, dof }) {
    const normal = point(shape.normal).normalize();
    const through = point(shape.through_m);
    const thick = 0.16 * radius_m;
    // As near to what else there is as the plane comes.
    const middle = around.clone().addScaledVector(normal, through.clone().sub(around).dot(normal));
    const wide = (dof === 1 ? 1.1 : 2.1) * radius_m;
    const deep = dof === 2 ? 0.12 * radius_m : wide;
    const slab = new BoxGeometry(wide, thick, deep);
    slab.translate(0, -thick / 2, 0);
    return { geometry: slab, middle, turn: new Quaternion().setFromUnitVectors(kUp, normal), endless: true };
  },

  sphere(shape, { radius_m, dof }) {
    const middle = point(shape.center_m);
    if (dof === 1) {
      return { geometry: new BoxGeometry(2 * shape.radius_m, 0.8 * radius_m, 0.8 * radius_m), middle };
    }
    if (dof === 2) {
      const disc = new CylinderGeometry(shape.radius_m, shape.radius_m, 0.12 * radius_m, 64).rotateX(Math.PI / 2);
      return { geometry: disc.translate(0, 0, -0.06 * radius_m), middle };
    }
    return { geometry: new SphereGeometry(shape.radius_m, 64, 40), middle };
  },

  cavity(shape, { radius_m, dof }) {
    const middle = point(shape.center_m);
    if (dof < 3) {
      const rim = new TorusGeometry(shape.radius_m + 0.03 * radius_m, 0.03 * radius_m, 12, 96);
      return { geometry: rim, middle };
    }
    return { geometry: new SphereGeometry(shape.radius_m, 64, 40), middle, side: BackSide };
  },

  box(shape, { radius_m, dof }) {
    const size = blockSize(shape.size_m, dof, (dof === 1 ? 0.8 : 0.12) * radius_m, 2 * radius_m);
    return { geometry: new BoxGeometry(...size), middle: point(shape.center_m) };
  },

  capsule(shape) {
    const { length, middle, turn } = along(shape);
    return { geometry: new CapsuleGeometry(shape.radius_m, length, 10, 32), middle, turn };
  },

  cylinder(shape) {
    const { length, middle, turn } = along(shape);
    return { geometry: new CylinderGeometry(shape.radius_m, shape.radius_m, length, 64), middle, turn };
  },

  torus(shape) {
    const turn = new Quaternion().setFromUnitVectors(kForward, point(shape.axis).normalize());
    const ring = new TorusGeometry(shape.major_radius_m, shape.minor_radius_m, 24, 96);
    return { geometry: ring, middle: point(shape.center_m), turn };
  },

  lathe(shape) {
    const [first, ...rest] = shape.profile_m.map(([radius, height]) => new Vector2(radius, height));
    const solid = new LatheGeometry([first, ...rest, first], shape.segments ?? 128).rotateX(Math.PI / 2);
    return { geometry: solid, middle: point(shape.origin_m), side: DoubleSide };
  },

  height_field(shape) {
    const rows = shape.heights_m;
    if (!rows?.length) return null;
    const columns = rows[0].length;
    const vertices = new Float32Array(3 * rows.length * columns);
    const triangles = [];
    rows.forEach((row, j) =>
      row.forEach((height, i) => {
        const v = j * columns + i;
        vertices.set([i * shape.spacing_m, j * shape.spacing_m, height], 3 * v);
        if (i + 1 < columns && j + 1 < rows.length) {
          triangles.push(v, v + 1, v + columns, v + 1, v + columns + 1, v + columns);
        }
      }));
    return { geometry: surface(vertices, triangles), middle: point(shape.origin_m), side: DoubleSide };
  },
};

function along(shape) {
  const from = point(shape.from_m);
  const axis = point(shape.to_m).sub(from);
  const length = axis.length();
  const middle = from.addScaledVector(axis, 0.5);
  return { length, middle, turn: new Quaternion().setFromUnitVectors(kUp, axis.divideScalar(length || 1)) };
}

function surface(vertices, triangles) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(vertices, 3));
  geometry.setIndex(triangles);
  geometry.computeVertexNormals();
  return geometry;
}

/**
 * @param {object} shape of a `scene` message
 * @param {{radius_m: number, around: Vector3, dof: number}} extent of the scene, for what is endless; axes of the device
 * @param {Object<string, import("three").Material>} materials solid, floor, inside, sheet
 * @param {import("three").Material} solid for what is seen from outside
 * @returns {Group|null} null for a kind that is not known
 */
export function makeShape(shape, extent, materials, solid = materials.solid) {
  const made = kinds[shape.kind]?.(shape, extent);
  if (!made) return null;
  const bySide = new Map([[FrontSide, solid], [BackSide, materials.inside], [DoubleSide, materials.sheet]]);
  const mesh = new Mesh(made.geometry, made.endless ? materials.floor : bySide.get(made.side ?? FrontSide));
  if (made.turn) mesh.quaternion.copy(made.turn);
  const group = new Group();
  group.name = shape.name;
  group.position.copy(made.middle);
  group.add(mesh);
  group.userData.endless = made.endless ?? false;
  return group;
}

/** @param {{name: string, vertices_m: number[], triangles: number[]}} message */
export function makeMesh(message, materials) {
  const mesh = new Mesh(surface(new Float32Array(message.vertices_m), message.triangles), materials.sheet);
  const group = new Group();
  group.name = message.name;
  group.add(mesh);
  return group;
}

/** Moves a mesh's vertices; one that moves so gets its edges drawn, which show how it deforms. */
export function deform(group, vertices_m, materials) {
  const mesh = group.children[0];
  const position = mesh.geometry.getAttribute("position");
  if (position.array.length !== vertices_m.length) return;
  position.array.set(vertices_m);
  position.needsUpdate = true;
  mesh.geometry.computeVertexNormals();
  mesh.geometry.boundingSphere = null;
  if (group.children.length > 1) return;
  mesh.material = materials.soft;
  const lines = new BufferGeometry();
  lines.setAttribute("position", position);
  lines.setIndex(edges(mesh.geometry.index.array));
  const drawn = new LineSegments(lines, materials.edges);
  drawn.frustumCulled = false;
  group.add(drawn);
}

/** Each edge of the triangles once. */
function edges(triangles) {
  const seen = new Set();
  const found = [];
  for (let i = 0; i < triangles.length; i += 3) {
    for (let k = 0; k < 3; ++k) {
      const a = triangles[i + k];
      const b = triangles[i + ((k + 1) % 3)];
      const key = Math.min(a, b) * 0x4000000 + Math.max(a, b);
      if (seen.has(key)) continue;
      seen.add(key);
      found.push(a, b);
    }
  }
  return found;
}
