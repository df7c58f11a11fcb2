// The motion before a change, seen through the one after it, with a button that hides it. Only pages that have one
// hold this.
"use strict";

(() => {
  const {earlier} = JSON.parse(document.getElementById("data").textContent);
  const {fit, show, state} = Replay.prototype;
  const COLOUR = 0xc0702a, SURFACE = 0.2, EDGES = 0.55;
  let on = true;

  function ghost(replay, one) {
    const body = replay.data.bodies[one.body], shape = replay.geometries[body.shape];
    const path = ["earlier", `${one.body} ${body.name}`];
    const seen = {color: COLOUR, transparent: true, depthWrite: false};
    if (shape.edges) {
      const surface = new replay.three.MeshLambertMaterial({...seen, flatShading: true, side: replay.three.DoubleSide, opacity: SURFACE});
      const edges = new replay.three.LineBasicMaterial({...seen, opacity: EDGES});
      replay.viewer.set_object(path.concat("surface"), new replay.three.Mesh(shape.surface, surface));
      replay.viewer.set_object(path.concat("edges"), new replay.three.LineSegments(shape.edges, edges));
    } else {
      const points = new replay.three.PointsMaterial({...seen, size: 2, sizeAttenuation: false});
      replay.viewer.set_object(path.concat("surface"), new replay.three.Points(shape.surface, points));
    }
    const node = replay.viewer.scene_tree.find(path).object;
    return {name: body.name, node, poses: decode(one.poses, Float32Array), shown: one.shown};
  }

  Replay.prototype.fit = function () {
    this.earlier = earlier.map((one) => ghost(this, one));
    fit.call(this);
  };

  Replay.prototype.show = function (frame, ...others) {
    for (const one of this.earlier) {
      this.place(one, frame);
      one.node.visible = on && (one.shown === null || one.shown[frame] === 1);
    }
    button.onclick = () => {
      on = !on;
      button.setAttribute("aria-pressed", on);
      this.show(this.frame, ...others);
    };
    show.call(this, frame, ...others);
  };

  Replay.prototype.state = function () {
    const found = this.earlier.filter((one) => one.node.visible).map((one) => [one.name, one.node.position.toArray()]);
    return {...state.call(this), earlier: Object.fromEntries(found)};
  };

  const button = document.createElement("button");
  button.type = "button";
  button.id = "earlier-motion";
  button.textContent = "Motion before";
  button.setAttribute("aria-pressed", on);
  document.getElementById("camera-gap").before(button);
})();
