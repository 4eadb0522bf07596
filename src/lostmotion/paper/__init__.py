"""The paper, reproduced: figures, tables and claims of Fietzek & Rinderknecht on the virtual rig, and its outlook."""

from __future__ import annotations

from .claim import Claim
from .reproduce import reproduce

__all__ = ["Claim", "reproduce"]
