"""The TOML's JSON schema, made from the models: for editors that complete keys and show what they mean."""

from __future__ import annotations

from typing import Any

from .models import ConfigurationModel


def configuration_schema() -> dict[str, Any]:
    """JSON schema (draft 2020-12) of a TOML for ``read_configuration``, which checks more than a schema can say."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "lostmotion: what a run needs to know about a rig",
        **_tidied(ConfigurationModel.model_json_schema()),
    }


def _tidied(part: Any) -> Any:
    """Without null, which TOML does not have, and without the titles, which repeat the keys."""
    if isinstance(part, list):
        return [_tidied(entry) for entry in part if entry != {"type": "null"}]
    if not isinstance(part, dict):
        return part
    kept = {key: _tidied(value) for key, value in part.items() if key != "title" and value is not None}
    if len(kept.get("anyOf", ())) == 1:  # the other one was null
        kept |= kept.pop("anyOf")[0]
    return kept
