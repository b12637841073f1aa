"""``python -m book.pictures`` draws the pictures of README and concepts anew, with robophm, matplotlib and Chromium."""

from __future__ import annotations

import math
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from playwright.sync_api import sync_playwright

import robophm
from book.pages import ROOT
from robophm.hazard.acceleration import arrhenius, q10

CONCEPTS = ROOT / "docs" / "concepts"
ONLY_CURVES = """for (const title of document.querySelectorAll('h2'))
  if (title.textContent.trim() !== 'Curves') title.parentElement.remove();"""
"""Leaves the head and the curves of a report."""


def report() -> None:
    """The head and the curves of the report that ``robophm demo`` writes."""
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as browsers:
        command = [sys.executable, "-m", "robophm", "demo", "--to", folder]
        subprocess.run(command, check=True, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        browser = browsers.chromium.launch(executable_path="/usr/bin/chromium", args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1180, "height": 700})
        page.goto((Path(folder) / "robophm-demo.html").as_uri())
        page.evaluate(ONLY_CURVES)
        page.screenshot(path=ROOT / "docs" / "report.png", full_page=True)
        browser.close()


def weibull(axes: Axes) -> None:
    """The hazard rate by age of parts with a mean life of 10,000 h, for four shapes."""
    ages = np.linspace(50, 20_000, 300)
    for shape in (0.7, 1, 2, 4):
        life = robophm.life_distribution("weibull")(scale=10_000 / math.gamma(1 + 1 / shape), shape=shape)
        axes.plot(ages, 1e6 * life.hazard(ages), label=f"β = {shape}")
    axes.set(xlabel="age [h]", ylabel="failures per 10⁶ h", ylim=(0, 400))


def temperature(axes: Axes) -> None:
    """How many times as fast parts age, beside 40 °C."""
    kelvin = np.linspace(20, 80, 121)
    for energy in (0.3, 0.5, 0.7):
        inputs = {"temperature": kelvin, "reference_temperature": 40.0, "activation_energy": energy}
        factor = arrhenius.evaluate(inputs).value
        axes.plot(kelvin, factor, label=f"Arrhenius, {energy} eV")
    axes.plot(
        kelvin,
        q10.evaluate({"temperature": kelvin, "reference_temperature": 40.0, "q": 2.0}).value,
        "--",
        label="twice per 10 K",
    )
    axes.set(xlabel="temperature [°C]", ylabel="acceleration ψ", yscale="log")


def redundancy(axes: Axes) -> None:
    """How likely equal parts of 100 FPMH, in four structures, work until an age."""
    hours = np.linspace(0, 20_000, 101)
    blocks = {
        "one": robophm.Series("a"),
        "two in series": robophm.Series("a", "b"),
        "one of two": robophm.Parallel("a", "b"),
        "two of three": robophm.KOutOfN(2, "a", "b", "c"),
    }
    for name, block in blocks.items():
        structure = robophm.Structure(block)
        alike = np.ones((len(structure.names), 1))
        axes.plot(
            hours, structure.state(np.exp(-1e-4 * hours) * alike, -np.expm1(-1e-4 * hours) * alike).works, label=name
        )
    axes.set(xlabel="hours", ylabel="reliability R", ylim=(0, 1))


def curves(folder: Path) -> None:
    """Draw the pictures of the concepts into ``folder``: with one version of matplotlib the same bytes each time."""
    with mpl.rc_context({"svg.hashsalt": "robophm", "font.size": 11}):
        for draw in (weibull, temperature, redundancy):
            figure, axes = plt.subplots(figsize=(7, 3.6), layout="constrained")
            draw(axes)
            axes.legend()
            axes.grid(alpha=0.3)
            figure.savefig(folder / f"{draw.__name__}.svg", metadata={"Date": None})
            plt.close(figure)


def main() -> None:
    """Draw all."""
    curves(CONCEPTS)
    report()


if __name__ == "__main__":
    main()
