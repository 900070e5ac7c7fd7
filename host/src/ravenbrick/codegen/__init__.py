# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Block diagrams become C and Ada."""

from __future__ import annotations

from ravenbrick.codegen.ada.binding import AdaBinding, ada_binding
from ravenbrick.codegen.ada.generator import generate_ada
from ravenbrick.codegen.ada.package import NamedNumber, ada_package
from ravenbrick.codegen.c.generator import GeneratedCode, generate_c
from ravenbrick.codegen.c.header import ModelHeader, read_header
from ravenbrick.codegen.coder_model import CoderModel, read_binding, read_coder_model
from ravenbrick.codegen.control_task import control_task
from ravenbrick.codegen.diagram_page import diagram_page
from ravenbrick.codegen.proofs.fixed_point import FixedPointProof, generate_fixed_c, prove
from ravenbrick.codegen.proofs.frama_c import FramaCResult, check_with_frama_c, frama_c_goals
from ravenbrick.codegen.proofs.gappa import check_with_gappa, gappa_script
from ravenbrick.codegen.variants import NumberChoice, Variant, number_variants
from ravenbrick.codegen.vectors import StepVectors, check_program, random_vectors

__all__ = [
    "AdaBinding",
    "CoderModel",
    "FixedPointProof",
    "FramaCResult",
    "GeneratedCode",
    "ModelHeader",
    "NamedNumber",
    "NumberChoice",
    "StepVectors",
    "Variant",
    "ada_binding",
    "ada_package",
    "check_program",
    "check_with_frama_c",
    "check_with_gappa",
    "control_task",
    "diagram_page",
    "frama_c_goals",
    "gappa_script",
    "generate_ada",
    "generate_c",
    "generate_fixed_c",
    "number_variants",
    "prove",
    "random_vectors",
    "read_binding",
    "read_coder_model",
    "read_header",
]
