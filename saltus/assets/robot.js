"use strict";
// One run in a scene of its own: ground, robot, contact forces, path of the centre of mass, and the plan as a ghost. z is up.

/// Length of an arrow, m per weight of the robot, and the longest.
const ARROW = 0.15, LONGEST_ARROW = 1.2;
/// Least force that is drawn, in weights.
const FELT = 0.02;
const GHOST = "#0969da", COM = "#cf222e";

const V = a => new THREE.Vector3(a[0], a[1], a[2]);
const Q = a => new THREE.Quaternion(a[0], a[1], a[2], a[3]);
const opaque = color => new THREE.MeshStandardMaterial({ color, roughness: 0.6 });
const glass = () => new THREE.MeshStandardMaterial({ color: GHOST, roughness: 0.6, transparent: true, opacity: 0.28 });

/// Lays a cylinder of length one, along y, from a to b.
function stretch(mesh, a, b) {
  const d = b.clone().sub(a), length = d.length();
  mesh.position.copy(a).addScaledVector(d, 0.5);
  mesh.scale.y = Math.max(length, 1e-6);
  if (length > 1e-6) mesh.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), d.divideScalar(length));
}

/// The two frames around a time, and where it is between them.
function around(times, t) {
  let lo = 0, hi = times.length - 1;
  while (hi - lo > 1) { const m = (lo + hi) >> 1; if (times[m] <= t) lo = m; else hi = m; }
  return [lo, hi, Math.min(1, Math.max(0, (t - times[lo]) / (times[hi] - times[lo] || 1)))];
}

/// The collision shapes of all links, the same as the simulators': capsules, a group per link; the base's link is -1.
class Body {
  constructor(scene, material) {
    this.group = new THREE.Group();
    this.links = new Map();
    /// Ends of all capsules: the group in which they stand, where, and how thick.
    this.ends = [];
    for (const shape of scene.shapes) {
      if (!this.links.has(shape.link)) {
        this.links.set(shape.link, new THREE.Group());
        this.group.add(this.links.get(shape.link));
      }
      const link = this.links.get(shape.link), look = material(shape), r = shape.radius;
      const add = mesh => { mesh.castShadow = !look.transparent; link.add(mesh); };
      for (const end of [V(shape.from), V(shape.to)]) {
        const cap = new THREE.Mesh(new THREE.SphereGeometry(r, 18, 12), look);
        cap.position.copy(end);
        add(cap);
        this.ends.push([link, end, r]);
      }
      const tube = new THREE.Mesh(new THREE.CylinderGeometry(r, r, 1, 18), look);
      stretch(tube, V(shape.from), V(shape.to));
      add(tube);
    }
    const nose = new THREE.Mesh(new THREE.BoxGeometry(0.03, 0.07, 0.04), material({ color: "#e3b341" }));
    nose.position.x = scene.nose;
    this.links.get(-1).add(nose);
  }

  /// Puts it where it is between two frames.
  pose(F, [i, j, s]) {
    this.links.forEach((group, link) => {
      const place = k => V(link < 0 ? F.position[k] : F.origins[k][link]);
      const turn = k => Q(link < 0 ? F.orientation[k] : F.turns[k][link]);
      group.position.copy(place(i)).lerp(place(j), s);
      group.quaternion.copy(turn(i)).slerp(turn(j), s);
    });
  }
}

/// A force as an arrow from a foot.
class Arrow {
  constructor(color) {
    const look = opaque(color);
    this.shaft = new THREE.Mesh(new THREE.CylinderGeometry(0.006, 0.006, 1, 10), look);
    this.head = new THREE.Mesh(new THREE.CylinderGeometry(0, 0.018, 1, 14), look);
    this.group = new THREE.Group();
    this.group.add(this.shaft, this.head);
  }

  set(foot, weights) {
    const size = weights.length();
    this.group.visible = size > FELT;
    if (!this.group.visible) return;
    const length = Math.min(LONGEST_ARROW, ARROW * size), along = weights.clone().divideScalar(size);
    const tip = foot.clone().addScaledVector(along, length);
    const neck = tip.clone().addScaledVector(along, -Math.min(0.05, 0.6 * length));
    stretch(this.shaft, foot, neck);
    stretch(this.head, neck, tip);
  }
}

class Stage {
  /// `color` is the run's own beside others, or nothing.
  constructor(run, color) {
    this.run = run;
    this.scene = new THREE.Scene();
    this.scene.background = new THREE.Color("#f6f8fa");
    /// Holds the world; what the camera looks at is the scene's origin.
    this.world = new THREE.Group();
    this.scene.add(this.world);
    this.light();
    this.ground = new THREE.Group();
    this.decoration = new THREE.Group();
    this.world.add(this.ground, this.decoration);
    this.lay(run.scene);
    this.body = new Body(run.scene, shape => opaque(shape.link < 0 && color ? color : shape.color));
    this.world.add(this.body.group);
    this.arrows = run.scene.feet.map(foot => new Arrow(foot));
    this.arrows.forEach(arrow => this.decoration.add(arrow.group));
    this.path(run.frames.com, COM);
    this.path(run.plan.com, GHOST);
    this.com = this.point(COM, 0.012);
    this.ghost = run.plan.origins ? new Body(run.scene, glass) : this.point(GHOST, 0.03);
    this.decoration.add(this.com.group, this.ghost.group);
    this.see();
  }

  light() {
    const sun = new THREE.DirectionalLight("#ffffff", 2.2);
    sun.position.set(1, -1.6, 4);
    sun.castShadow = true;
    sun.shadow.mapSize.set(1024, 1024);
    Object.assign(sun.shadow.camera, { left: -1.6, right: 1.6, top: 1.6, bottom: -1.6, near: 0.5, far: 9 });
    sun.shadow.bias = -0.002;
    this.scene.add(new THREE.HemisphereLight("#ffffff", "#b6bec7", 1.9), sun, sun.target);
  }

  /// Floor, the box on it, and the goal.
  lay(scene) {
    const slab = (lo, hi, color) => {
      const box = new THREE.Mesh(new THREE.BoxGeometry(hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2]), opaque(color));
      box.position.set((hi[0] + lo[0]) / 2, (hi[1] + lo[1]) / 2, (hi[2] + lo[2]) / 2);
      box.receiveShadow = true;
      this.ground.add(box);
      return box;
    };
    slab([-5, -5, scene.floor - 0.02], [5, 5, scene.floor - 0.003], "#eef1f4");
    // In tiles: some renderers lose a line that ends behind the camera.
    for (let k = 0; k < 25; k++) {
      const grid = new THREE.GridHelper(2, 20, "#9aa6b3", "#cbd3db");
      grid.rotation.x = Math.PI / 2;
      grid.position.set(2 * (k % 5) - 4, 2 * Math.floor(k / 5) - 4, scene.floor);
      this.ground.add(grid);
    }
    if (scene.block) slab(scene.block[0], scene.block[1], "#d3dae1").castShadow = true;
    const goal = new THREE.Mesh(new THREE.CylinderGeometry(0.03, 0.03, 0.004, 24), opaque("#1a7f37"));
    goal.rotation.x = Math.PI / 2;
    goal.position.set(scene.goal[0], scene.goal[1], this.height(scene.goal[0], scene.goal[1], 0) + 0.002);
    this.ground.add(goal);
  }

  /// A centre of mass as a ball, which is seen through the robot.
  point(color, radius) {
    const group = new THREE.Group(), look = opaque(color);
    Object.assign(look, { transparent: true, opacity: 0.7, depthTest: false });
    group.add(new THREE.Mesh(new THREE.SphereGeometry(radius, 20, 14), look));
    return { group, pose: (F, [i, j, s]) => group.position.copy(V(F.com[i])).lerp(V(F.com[j]), s) };
  }

  /// A path, seen through the robot.
  path(points, color) {
    const line = new THREE.BufferGeometry();
    line.setAttribute("position", new THREE.BufferAttribute(new Float32Array(points.flat()), 3));
    this.decoration.add(new THREE.Line(line, new THREE.LineBasicMaterial({ color, transparent: true, opacity: 0.8, depthTest: false })));
  }

  /// How much of the world is seen, and around which height: all of a jump that fits, else what is around the robot.
  see() {
    const F = this.run.frames, tops = F.t.map((t, i) => {
      this.body.pose(F, [i, i, 0]);
      this.world.updateMatrixWorld(true);
      return Math.max(...this.body.ends.map(([link, end, radius]) => end.clone().applyMatrix4(link.matrixWorld).z + radius));
    });
    const start = F.position[0], stands = this.height(start[0], start[1], F.t[0]);
    const high = Math.max(...tops), low = Math.min(stands, this.run.scene.floor);
    this.rises = high - low > 1.7;
    this.extent = this.rises ? 2.2 * (tops[0] - stands) : high - low;
    // What is nearer stands lower in the picture.
    this.middle = (high + low) / 2 - 0.05 * this.extent;
  }

  /// By how much the floor has moved.
  moved(t) {
    const F = this.run.frames;
    return F.floor ? F.floor[around(F.t, t)[0]] : 0;
  }

  /// Height of the ground at a place.
  height(x, y, t) {
    const { block, floor } = this.run.scene;
    const inside = block && [x, y].every((p, axis) => block[0][axis] <= p && p <= block[1][axis]);
    return inside ? block[1][2] : floor + this.moved(t);
  }

  /// Shows the run at a time of its own.
  show(t, { forces, plan, follow }) {
    const F = this.run.frames, P = this.run.plan, at = around(F.t, t), [i, j, s] = at;
    this.now = t;
    this.body.pose(F, at);
    this.arrows.forEach((arrow, k) => {
      const mix = list => V(list[i][k]).lerp(V(list[j][k]), s);
      arrow.set(mix(F.feet), mix(F.forces).divideScalar(this.run.weight));
      arrow.group.visible &&= forces;
    });
    this.ghost.group.visible = plan && t <= P.t[P.t.length - 1];
    this.ghost.pose(P, around(P.t, t));
    this.com.pose(F, at);
    this.ground.position.z = this.moved(t);
    const seen = follow ? V(F.position[i]).lerp(V(F.position[j]), s) : V(F.position[0]);
    if (!(follow && this.rises)) seen.z = this.middle;
    this.world.position.copy(seen).negate();
    return F.phase[i];
  }

  /// How deep the deepest end of a link is under the ground now, m; negative in the air.
  depth() {
    this.world.updateMatrixWorld(true);
    let deepest = -Infinity;
    for (const [link, end, radius] of this.body.ends) {
      const p = this.world.worldToLocal(end.clone().applyMatrix4(link.matrixWorld));
      deepest = Math.max(deepest, this.height(p.x, p.y, this.now) - p.z + radius);
    }
    return deepest;
  }

  /// Shows nothing but the robot, so that every pixel is its own; or all again.
  bare(on) {
    this.ground.visible = this.decoration.visible = !on;
  }
}
