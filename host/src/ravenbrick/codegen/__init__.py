# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Block diagrams become C."""

from __future__ import annotations

from ravenbrick.codegen.ada import NamedNumber, ada_package
from ravenbrick.codegen.gappa import check_with_gappa, gappa_script
from ravenbrick.codegen.generator import GeneratedCode, generate_c
from ravenbrick.codegen.proof import FixedPointProof, generate_fixed_c, prove
from ravenbrick.codegen.vectors import StepVectors, check_program, random_vectors

__all__ = [
    "FixedPointProof",
    "GeneratedCode",
    "NamedNumber",
    "StepVectors",
    "ada_package",
    "check_program",
    "check_with_gappa",
    "gappa_script",
    "generate_c",
    "generate_fixed_c",
    "prove",
    "random_vectors",
]
