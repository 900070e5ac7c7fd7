# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Simulink models become diagrams."""

from __future__ import annotations

from ravenbrick.simulink.file import read_simulink
from ravenbrick.simulink.importer import (
    Imported,
    ModelSource,
    Refusal,
    Survey,
    import_model,
    import_simulink,
    survey_simulink,
)
from ravenbrick.simulink.workspace import read_workspace

__all__ = [
    "Imported",
    "ModelSource",
    "Refusal",
    "Survey",
    "import_model",
    "import_simulink",
    "read_simulink",
    "read_workspace",
    "survey_simulink",
]
