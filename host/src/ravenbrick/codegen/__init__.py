# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Block diagrams become C."""

from __future__ import annotations

from ravenbrick.codegen.ada import NamedNumber, ada_package
from ravenbrick.codegen.generator import GeneratedCode, generate_c
from ravenbrick.codegen.vectors import StepVectors, check_program, random_vectors

__all__ = [
    "GeneratedCode",
    "NamedNumber",
    "StepVectors",
    "ada_package",
    "check_program",
    "generate_c",
    "random_vectors",
]
