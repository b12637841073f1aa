"""Points of a plot that stand alone."""

from __future__ import annotations

from ..conftest import SMALL, serving

DOTS = """(name) => {
  const plot = [...document.querySelectorAll(".plot")].find((one) => one.ariaLabel === name);
  const canvas = plot?.querySelector("canvas");
  if (!canvas) return 0;
  const probe = document.createElement("canvas").getContext("2d");
  probe.fillStyle = getComputedStyle(document.documentElement).getPropertyValue("--c0");
  probe.fillRect(0, 0, 1, 1);
  const [red, green, blue] = probe.getImageData(0, 0, 1, 1).data;
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let count = 0;
  for (let i = 0; i < data.length; i += 4) count += data[i] === red && data[i + 1] === green && data[i + 2] === blue;
  return count;
}"""
"""How many pixels of a plot have the colour of its first curve."""


def test_a_point_that_no_line_reaches_is_a_dot(visit, tmp_path):
    table = tmp_path / "drive.csv"
    rows = [f"{1_700_000_000 + t},{30 if t == 20 else ''},{20 + t}" for t in range(60)]
    table.write_text("\n".join(["time,/motor.t,/lidar.t", *rows]) + "\n")
    text = SMALL.replace(
        "rate: 8 FPMH}", "rate: 8 FPMH, signals: {temperature: {topic: /motor, field: t, unit: degC}}}"
    )
    text = text.replace("lidar: {", "lidar: {signals: {temperature: {topic: /lidar, field: t, unit: K}}, ")
    (tmp_path / "courier.yaml").write_text(text)
    with serving(tmp_path / "courier.yaml", seed=1, recordings=(table,), store=str(tmp_path / "past.db")) as courier:
        courier.post("/api/monitoring/start", {"source": "recordings", "speed": 100})
        look = visit(courier)
        page = look.open("live")
        page.get_by_text("Recording over").wait_for()
        page.get_by_role("region", name="Sensors in °C").wait_for()
        page.wait_for_function(f"name => ({DOTS})(name) > 200", arg="Sensors in K")  # a line
        page.wait_for_function(f"name => ({DOTS})(name) > 8 && ({DOTS})(name) < 100", arg="Sensors in °C")
