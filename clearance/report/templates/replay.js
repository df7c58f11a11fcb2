// The replay: meshcat's viewer with all bodies and the line between the witness points.
// It knows frames, not times; page.js decides which frame is shown.
"use strict";

const ROBOTS = [0x5c7390, 0x7d6796, 0x4b7f78, 0x94705c]; // as --hand0 to --hand3 of the page
const LINK_IDLE = 0xa9b4c0, OBSTACLE = 0xb9b4a8, MOVING = 0x9c9480, PART = 0xb3892f;
const SOLID = {link: 1, part: 1, moving: 0.72, obstacle: 0.5};
const LINE_PIXELS = 2.4, DOT_PIXELS = 4;
const EDGE = {light: 0x1c2530, dark: 0xd8e0e8}, GRID = {light: [0xd3d8dc, 0xe3e7ea], dark: [0x3a444f, 0x2b333c]};
const EARLIER = 0xc0702a; // the motion before a change, seen through the one after it
const REGION = 0xe01010, WAY_OUT = 0x4a0008, ARROW_PIXELS = 78;

function decode(text, Kind) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Kind(bytes.buffer);
}

class Replay {
  // colours: of each status, as CSS; theme: "light" or "dark".
  constructor(pane, data, colours, theme) {
    this.data = data;
    this.colours = colours;
    this.theme = theme;
    this.pane = pane;
    this.three = MeshCat.THREE;
    this.viewer = new MeshCat.Viewer(pane);
    this.viewer.gui.domElement.style.display = "none";
    this.viewer.hide_background();
    this.lines = decode(data.lines, Float64Array);
    this.times = decode(data.times, Float64Array);
    this.geometries = data.shapes.map((shape) => this.geometry(shape));
    this.bodies = data.bodies.map((body, i) => this.body(body, i));
    this.marks();
    this.contacts = data.contacts.map((contact, i) => this.contact(contact, i));
    this.earlier = (data.earlier || []).map((one) => this.ghost(one));
    this.showsEarlier = true;
    this.fit();
    // meshcat sizes its canvas by the window; ours stands in a figure
    this.viewer.set_3d_pane_size = () => Object.getPrototypeOf(this.viewer).set_3d_pane_size.call(
      this.viewer, pane.clientWidth, pane.clientHeight);
    new ResizeObserver(() => this.viewer.set_3d_pane_size()).observe(pane);
    this.viewer.set_3d_pane_size();
  }

  geometry(shape) {
    const geometry = new this.three.BufferGeometry();
    geometry.setAttribute("position", new this.three.BufferAttribute(decode(shape.vertices, Float32Array), 3));
    const triangles = decode(shape.triangles, Uint32Array);
    geometry.computeBoundingBox();
    if (!triangles.length) return {surface: geometry}; // a cloud of points
    geometry.setIndex(new this.three.BufferAttribute(triangles, 1));
    geometry.computeVertexNormals();
    return {surface: geometry, edges: new this.three.EdgesGeometry(geometry, 25)};
  }

  body(body, i) {
    const opacity = SOLID[body.kind], solid = opacity === 1, colour = this.colourOf(body), shape = this.geometries[body.shape];
    const look = {color: colour, transparent: !solid, opacity, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1};
    const edges = {color: EDGE[this.theme], transparent: true, opacity: solid ? 0.35 : 0.28};
    const made = {...this.solid([body.kind + "s", `${i} ${body.name}`], shape, look, edges), colour,
      poses: decode(body.poses, Float32Array), bounds: shape.surface.boundingBox, kind: body.kind, shown: body.shown};
    this.place(made, 0);
    return made;
  }

  // A shape at a place of the scene: its surface and edges, or its points.
  solid(path, shape, look, edges) {
    let surface = new this.three.MeshLambertMaterial({flatShading: true, side: this.three.DoubleSide, ...look});
    if (shape.edges) {
      this.viewer.set_object(path.concat("surface"), new this.three.Mesh(shape.surface, surface));
      this.viewer.set_object(path.concat("edges"), new this.three.LineSegments(shape.edges, new this.three.LineBasicMaterial(edges)));
    } else {
      surface = new this.three.PointsMaterial({color: look.color, size: 2, sizeAttenuation: false});
      this.viewer.set_object(path.concat("surface"), new this.three.Points(shape.surface, surface));
    }
    return {node: this.viewer.scene_tree.find(path).object, surface};
  }

  // Where a body was before a change.
  ghost(one) {
    const {name, shape} = this.data.bodies[one.body], seen = {color: EARLIER, transparent: true, depthWrite: false};
    const made = this.solid(["earlier", `${one.body} ${name}`], this.geometries[shape], {...seen, opacity: 0.2}, {...seen, opacity: 0.55});
    return {...made, name, poses: decode(one.poses, Float32Array), shown: one.shown};
  }

  colourOf(body) {
    if (body.kind === "link") return body.measured ? ROBOTS[body.robot % ROBOTS.length] : LINK_IDLE;
    return {part: PART, moving: MOVING, obstacle: OBSTACLE}[body.kind];
  }

  // A part in a robot's hand has some of its colour, so that it is seen to change hands.
  tint(body, i, frame) {
    body.surface.color.set(body.colour);
    if (body.kind !== "part") return;
    const time = this.times[frame];
    const held = this.data.carries.find((one) => one.i_part === i && one.start <= time && time < one.end);
    if (held && held.i_by >= 0) body.surface.color.lerp(new this.three.Color(this.colourOf(this.data.bodies[held.i_by])), 0.6);
  }

  // The line and its two dots: drawn over everything, as thick on the screen from near as from far.
  marks() {
    const material = new this.three.MeshBasicMaterial({depthTest: false, depthWrite: false, transparent: true});
    const tube = new this.three.CylinderGeometry(1, 1, 1, 12);
    tube.rotateX(Math.PI / 2);
    const ball = new this.three.SphereGeometry(1, 20, 14);
    const add = (name, geometry, pixels, along) => {
      const mesh = new this.three.Mesh(geometry, material);
      mesh.renderOrder = 10;
      mesh.frustumCulled = false;
      mesh.onBeforeRender = (renderer, scene, camera) => this.keepSize(mesh, camera, pixels, along);
      this.viewer.set_object(["clearance", name], mesh);
      return mesh;
    };
    this.line = add("line", tube, LINE_PIXELS / 2, true);
    this.dots = [add("first point", ball, DOT_PIXELS, false), add("second point", ball, DOT_PIXELS, false)];
    this.material = material;
  }

  // The region that two bodies share, seen through both of them, and the separation vector of the first.
  contact(contact, i) {
    const geometry = new this.three.BufferGeometry();
    geometry.setAttribute("position", new this.three.BufferAttribute(decode(contact.vertices, Float32Array), 3));
    geometry.setIndex(new this.three.BufferAttribute(decode(contact.triangles, Uint32Array), 1));
    const seen = {depthTest: false, depthWrite: false, transparent: true};
    const region = new this.three.Mesh(geometry, new this.three.MeshBasicMaterial({...seen, color: REGION, opacity: 0.45, side: this.three.DoubleSide}));
    const edges = new this.three.LineSegments(new this.three.EdgesGeometry(geometry, 15), new this.three.LineBasicMaterial({...seen, color: REGION}));
    const arrow = new this.three.Group();
    const shaft = new this.three.CylinderGeometry(0.028, 0.028, 0.76, 12).translate(0, 0.38, 0);
    const tip = new this.three.ConeGeometry(0.095, 0.26, 20).translate(0, 0.87, 0);
    for (const part of [shaft, tip]) {
      const mesh = new this.three.Mesh(part, new this.three.MeshBasicMaterial({...seen, color: WAY_OUT}));
      mesh.renderOrder = 12;
      mesh.frustumCulled = false;
      arrow.add(mesh);
    }
    arrow.children[0].onBeforeRender = (renderer, scene, camera) => this.keepLength(arrow, camera);
    arrow.position.set(...contact.start);
    arrow.quaternion.setFromUnitVectors(new this.three.Vector3(0, 1, 0), new this.three.Vector3(...contact.direction));
    region.renderOrder = 8;
    edges.renderOrder = 9;
    const made = {frame: contact.frame, parts: [region, edges, arrow], arrow, region};
    made.parts.forEach((part, k) => {
      part.visible = false;
      this.viewer.set_object(["contacts", `${i}`, ["region", "edges", "arrow"][k]], part);
    });
    return made;
  }

  keepLength(arrow, camera) {
    const eye = new this.three.Vector3().setFromMatrixPosition(camera.matrixWorld);
    const foot = new this.three.Vector3().setFromMatrixPosition(arrow.matrixWorld);
    const height = 2 * eye.distanceTo(foot) * Math.tan(camera.fov * Math.PI / 360);
    arrow.scale.setScalar(ARROW_PIXELS * height / this.pane.clientHeight);
    arrow.updateMatrixWorld(true);
  }

  keepSize(mesh, camera, pixels, along) {
    const eye = new this.three.Vector3().setFromMatrixPosition(camera.matrixWorld);
    const centre = new this.three.Vector3().setFromMatrixPosition(mesh.matrixWorld);
    const height = 2 * eye.distanceTo(centre) * Math.tan(camera.fov * Math.PI / 360);
    const radius = pixels * height / this.pane.clientHeight;
    mesh.scale.set(radius, radius, along ? mesh.scale.z : radius);
    mesh.updateMatrixWorld(true);
  }

  place(body, frame) {
    const start = body.poses.length > 7 ? 7 * frame : 0;
    const pose = body.poses.subarray(start, start + 7);
    body.node.position.set(pose[0], pose[1], pose[2]);
    body.node.quaternion.set(pose[3], pose[4], pose[5], pose[6]);
  }

  // Of the nearest pair, or of the one that is chosen: its line (6 numbers), its bodies and its status.
  show(frame, chosen = null) {
    const {data} = this;
    this.frame = frame;
    this.nearest = chosen ? chosen.bodies : data.nearest[frame];
    this.ends = chosen ? chosen.line : this.lines.subarray(6 * frame, 6 * frame + 6);
    const colour = new this.three.Color(this.colours[chosen ? chosen.status : data.status[frame]]);
    this.bodies.forEach((body, i) => {
      if (body.poses.length > 7) this.place(body, frame);
      if (body.shown) body.node.visible = body.shown[body.shown.length > 1 ? frame : 0] === 1;
      this.tint(body, i, frame);
      if (this.nearest.includes(i)) body.surface.color.lerp(colour, 0.55);
    });
    for (const one of this.earlier) {
      this.place(one, frame);
      one.node.visible = this.showsEarlier && (!one.shown || one.shown[frame] === 1);
    }
    this.material.color.copy(colour);
    for (const contact of this.contacts) for (const part of contact.parts) part.visible = contact.frame === frame;
    const ends = [0, 3].map((at) => new this.three.Vector3().fromArray(this.ends, at));
    this.dots.forEach((dot, i) => { dot.position.copy(ends[i]); dot.visible = chosen !== null || data.known[frame] === 1; });
    const along = ends[1].clone().sub(ends[0]);
    const length = along.length();
    this.line.visible = length > 0;
    this.line.position.copy(ends[0]).add(ends[1]).multiplyScalar(0.5);
    if (length > 0) {
      this.line.quaternion.setFromUnitVectors(new this.three.Vector3(0, 0, 1), along.divideScalar(length));
      this.line.scale.z = length;
    }
    this.viewer.set_dirty();
  }

  // What the scene graph really holds, in the world frame: for tests and for the curious.
  state() {
    const scene = this.viewer.scene;
    scene.updateMatrixWorld(true);
    const worldFromView = scene.matrixWorld.clone().invert();
    const world = (object, z) => new this.three.Vector3(0, 0, z).applyMatrix4(object.matrixWorld).applyMatrix4(worldFromView);
    const bodies = {};
    this.bodies.forEach((body, i) => { bodies[this.data.bodies[i].name] = world(body.node, 0).toArray(); });
    return {
      frame: this.frame,
      step: this.data.steps[this.frame],
      nearest: this.nearest.map((i) => i < 0 ? null : this.data.bodies[i].name),
      line: this.line.visible ? [-0.5, 0.5].map((z) => world(this.line, z).toArray()) : null,
      dots: this.dots.map((dot) => world(dot, 0).toArray()),
      contacts: this.contacts.filter((contact) => contact.region.visible).map((contact) => ({
        foot: contact.arrow.position.toArray(),
        direction: new this.three.Vector3(0, 1, 0).applyQuaternion(contact.arrow.quaternion).toArray(),
        corners: contact.region.geometry.getAttribute("position").count,
      })),
      camera: this.looks(),
      colour: "#" + this.material.color.getHexString(),
      bodies,
      earlier: Object.fromEntries(this.earlier.filter((one) => one.node.visible).map((one) => [one.name, one.node.position.toArray()])),
      hidden: this.data.bodies.filter((body, i) => !this.bodies[i].node.visible).map((body) => body.name),
    };
  }

  // Eye and target in the world frame.
  looks() {
    const {camera, controls} = this.viewer;
    return [camera.position, controls.target].map((at) => [at.x, -at.z, at.y]);
  }

  worldBox(chosen, frames) {
    const box = new this.three.Box3();
    for (const body of chosen) for (const frame of body.poses.length > 7 ? frames : [0]) {
      this.place(body, frame);
      body.node.updateMatrix();
      box.union(body.bounds.clone().applyMatrix4(body.node.matrix));
    }
    return box;
  }

  // The room of all that moves, and of the obstacles what stands in or near it, decide what the camera frames.
  fit() {
    const n = this.data.steps.length;
    const frames = Array.from({length: Math.min(n, 60)}, (_, i) => Math.floor(i * (n - 1) / Math.max(1, Math.min(n, 60) - 1)));
    const room = this.worldBox(this.bodies.filter((body) => body.kind !== "obstacle"), frames);
    const all = this.worldBox(this.bodies.filter((body) => body.kind === "obstacle"), [0]);
    const reach = room.getSize(new this.three.Vector3()).length();
    this.box = room.clone().expandByScalar(0.25 * reach).intersect(all.union(room));
    this.size = this.box.getSize(new this.three.Vector3()).length();
    this.viewer.camera.near = this.size / 2000;
    this.viewer.camera.far = this.size * 40;
    this.viewer.camera.fov = 40;
    this.floor();
  }

  // A grid with a round spacing under the robot's room and a little beyond, on z = 0 or below what is lower.
  floor() {
    const spacing = 10 ** Math.round(Math.log10(this.size / 12));
    const cells = 2 * Math.ceil(0.9 * this.size / spacing);
    const grid = new this.three.GridHelper(cells * spacing, cells, ...GRID[this.theme]);
    grid.rotateX(Math.PI / 2);
    const centre = this.box.getCenter(new this.three.Vector3());
    grid.position.set(Math.round(centre.x / spacing) * spacing, Math.round(centre.y / spacing) * spacing, Math.min(0, this.box.min.z));
    this.viewer.set_object(["Grid"], grid);
    this.viewer.set_property(["Axes"], "visible", false);
  }

  overview() {
    const centre = this.box.getCenter(new this.three.Vector3());
    this.look(centre, 0.5 * this.size / Math.sin(this.viewer.camera.fov * Math.PI / 360) * 0.8);
  }

  atGap() {
    const ends = [0, 3].map((at) => new this.three.Vector3().fromArray(this.ends, at));
    this.look(ends[0].clone().add(ends[1]).multiplyScalar(0.5), Math.max(6 * ends[0].distanceTo(ends[1]), this.size / 12));
  }

  // From whichever side shows the line, or in contact the separation vector, least hidden and most from its side.
  look(target, distance) {
    const line = new this.three.Vector3().fromArray(this.ends, 3).sub(new this.three.Vector3().fromArray(this.ends)).normalize();
    const contact = this.data.contacts.find((one) => one.frame === this.frame);
    if (contact) line.set(...contact.direction);
    const middle = new this.three.Vector3().fromArray(this.ends)
      .add(new this.three.Vector3().fromArray(this.ends, 3)).multiplyScalar(0.5);
    let best = null;
    for (let k = 0; k < 16; k++) {
      const turn = (k + 0.5) * Math.PI / 8, lift = 0.42;
      const direction = new this.three.Vector3(Math.cos(turn) * Math.cos(lift), Math.sin(turn) * Math.cos(lift), Math.sin(lift));
      const eye = target.clone().addScaledVector(direction, distance);
      const cost = this.hidden(middle, eye) + 0.8 * Math.abs(direction.dot(line));
      if (best === null || cost < best.cost - 1e-9) best = {cost, eye};
    }
    this.aim(best.eye, target);
  }

  aim(eye, target) {
    const {camera, controls} = this.viewer;
    camera.position.set(eye.x, eye.z, -eye.y);
    controls.target.set(target.x, target.z, -target.y);
    controls.update();
    this.viewer.set_dirty();
  }

  // How many bodies, by their boxes, stand between the eye and the line.
  hidden(point, eye) {
    const ray = new this.three.Ray(point, eye.clone().sub(point).normalize());
    const span = eye.distanceTo(point);
    return this.bodies.filter((body, i) => {
      if (this.nearest.includes(i) || !body.node.visible) return false;
      body.node.updateMatrix();
      const hit = ray.intersectBox(body.bounds.clone().applyMatrix4(body.node.matrix), new this.three.Vector3());
      return hit !== null && hit.distanceTo(point) < span;
    }).length;
  }

  image() {
    return this.viewer.capture_image();
  }
}
