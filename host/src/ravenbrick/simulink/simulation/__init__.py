# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Simulation of Simulink models in continuous time, with their sampled parts at their rates."""
