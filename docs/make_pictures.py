"""Makes the README's picture: python docs/make_pictures.py"""

from __future__ import annotations

from pathlib import Path

from lostmotion import plot
from lostmotion.stages.design import design
from lostmotion.stages.material import from_rig
from lostmotion.stages.parameters import find_parameters
from lostmotion.stages.validation import validate

IMAGES = Path(__file__).parent / "images"


def main() -> None:
    material, _ = from_rig(1)
    found = find_parameters(material)
    laws = design(material, found)
    validation = validate(material, found, laws)
    figure = plot.control_step(
        {
            "PI of the paper": validation.responses["pi"],
            "Observer 1 + pole placement": validation.responses["pole_placement"],
        },
        start=0.97,
        stop=1.16,
        torque_limit=laws.torque_limit,
        title="Step of the load speed on the virtual rig, the load not measured (simulated)",
    )
    figure.savefig(IMAGES / "step.png", dpi=110, facecolor="white")


if __name__ == "__main__":
    main()
