"""The paper's powertrain as a finite-element model; data that the paper does not give are chosen or solved for."""

from __future__ import annotations

from ..argument_checks import checks_arguments
from .elements import Coupling, Disc, Part, ShaftSegment
from .torsional_model import DAMPING_RATIO, TorsionalModel, assemble

#: Last node before the gap: the tripod, on the end of the side shaft; its housing belongs to the hub.
GAP = "joint"

#: Motor – clutch – intermediate shaft – side shaft – tripod joint – wheel hub with brake disc (Fietzek & Rinderknecht,
#: section I). Lengths, tube diameters, motor, joint, hub and flange are options; clutch, clutch output, the side
#: shaft's diameter and the brake disc were solved for 100 Hz, 750 Hz, a motor zero at 38 Hz and 0.1292 kg m² in total.
PARTS: tuple[Part, ...] = (
    Disc("motor", 0.0142),
    Coupling("clutch", 81_400.0),
    Disc("clutch output", 0.003584),
    ShaftSegment("intermediate shaft", 0.30, 0.060, 0.050, elements=4),
    ShaftSegment("side shaft", 0.45, 0.02588, elements=8),
    Disc(GAP, 0.0003),
    Coupling("tripod", 80_000.0),
    Disc("hub", 0.0046),
    Coupling("flange", 2.0e6),
    Disc("brake disc", 0.104809),
)


@checks_arguments
def paper_powertrain(*, damping_ratio: float = DAMPING_RATIO) -> TorsionalModel:
    """The paper's powertrain with the gap closed: eigenmodes at 0, 100 and 750 Hz, motor zero 38 Hz, 0.1292 kg m².

    Examples
    --------
    >>> from lostmotion.structure import modes, paper_powertrain
    >>> [round(float(f)) for f in modes(paper_powertrain()).frequency[:3]]
    [0, 100, 750]
    """
    return assemble(PARTS, damping_ratio=damping_ratio)
