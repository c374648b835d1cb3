// Play, pause, one frame, any kept frame, speed, and what a frame costs.

const element = (id) => document.getElementById(id);

export class TimeBar {
  constructor(source) {
    this.source = source;
    this.playing = false;
    element("latest").hidden = true;
    element("latest").addEventListener("click", () => source.send({ op: "seek", frame: Infinity }));
    element("play").addEventListener("click", () => this.toggle());
    element("step").addEventListener("click", () => source.send({ op: "step" }));
    element("first").addEventListener("click", () => source.send({ op: "seek", frame: 0 }));
    element("scrub").addEventListener("input", ({ target }) =>
      source.send({ op: "seek", frame: Number(target.value) }),
    );
    element("speed").addEventListener("change", ({ target }) =>
      source.send({ op: "speed", factor: Number(target.value) }),
    );
  }

  toggle() {
    this.source.send({ op: this.playing ? "pause" : "play" });
  }

  play(on) {
    this.playing = on;
    element("play").textContent = on ? "❚❚" : "▶";
    element("play").setAttribute("aria-label", on ? "Pause" : "Play");
  }

  /** Where the frame that is shown stands among those that can be shown, and whether the page looks back at it. */
  place({ number, count }, looksBack = false) {
    element("scrub").max = count - 1;
    element("scrub").value = number;
    element("latest").hidden = !looksBack;
  }

  show({ frame, time_s, speed, step_ms, playing, number, count }) {
    this.play(playing);
    if (count) this.place({ number, count });
    element("scrub").setAttribute("aria-valuetext", `${time_s.toFixed(3)} s`);
    element("clock").textContent = `${time_s.toFixed(3)} s · frame ${frame}`;
    const rate = speed ? `${speed.toFixed(2)} × real time · ` : "";
    element("rate").textContent = step_ms === null ? "" : `${rate}${step_ms.toFixed(1)} ms per frame`;
  }
}
