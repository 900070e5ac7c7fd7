# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Task sets of the literature, with the response times that follow from them.

Rows are (C, T) or (C, T, D), most urgent first. Sources: A. Burns and A. Wellings, Real-Time
Systems and Programming Languages (sets A to D, deadline monotonic table); Sha and Goodenough 1990;
Lehoczky 1990 (arbitrary deadlines); Davis, Burns, Bril, Lukkien 2007 (non-preemptive); Locke,
Vogel, Mesler 1991 (generic avionics platform); Katcher, Arakawa, Strosnider 1993 (inertial
navigation system). The response times of the two last ones and of the satellite were computed
from the parameters, not taken from the papers; the parameters of these three are as usually
quoted.
"""

from __future__ import annotations

from fractions import Fraction

__all__ = ["HERSCHEL", "HERSCHEL_PHASES", "SETS"]

Row = tuple[object, ...]

SETS: dict[str, tuple[list[Row], list[str]]] = {
    "Burns and Wellings, set A": ([(10, 30), (10, 40), (12, 50)], ["10", "20", "52"]),
    "Burns and Wellings, set B": ([(4, 16), (5, 40), (32, 80)], ["4", "9", "58"]),
    "Burns and Wellings, set C": ([(5, 20), (10, 40), (40, 80)], ["5", "15", "80"]),
    "Burns and Wellings, set D": ([(3, 7), (3, 12), (5, 20)], ["3", "6", "20"]),
    "Sha and Goodenough, second set": (
        [(40, 100), (40, 150), (100, 350)],
        ["40", "80", "300"],
    ),
    "Liu and Layland, two tasks": ([(1, 2), (2, 5)], ["1", "4"]),
    "Burns and Wellings, deadline monotonic": (
        [(3, 20, 5), (3, 15, 7), (4, 10, 10), (3, 20, 20)],
        ["3", "6", "10", "20"],
    ),
    "Lehoczky, arbitrary deadlines": ([(26, 70), (62, 100)], ["26", "118"]),
    "two tasks with D > T": ([(52, 100, 110), (52, 140, 154)], ["52", "156"]),
    "Burns and Wellings, before offsets": (
        [(4, 8, 5), (4, 20, 10), (4, 20, 12)],
        ["4", "8", "16"],
    ),
    "generic avionics platform": (
        [
            (3, 200, 5),
            (2, 25),
            (5, 25),
            (1, 40),
            (3, 50),
            (5, 50),
            (8, 59),
            (9, 80),
            (2, 80),
            (5, 100),
            (3, 200),
            (1, 200),
            (1, 200),
            (3, 200),
            (1, 1000),
            (1, 1000),
        ],
        "3 5 10 11 14 19 34 44 46 74 96 97 98 137 138 139".split(),
    ),
    "inertial navigation system": (
        [
            ("1.18", "2.5"),
            ("4.28", 40),
            ("10.28", "62.5"),
            ("20.28", 1000),
            ("100.28", 1000),
            (25, 1250),
        ],
        "1.18 9.00 28.72 102.06 489.72 592.22".split(),
    ),
    "Olympus attitude and orbit control": (
        [
            (".28", 50),
            ("1.76", 10),
            ("2.13", 200),
            ("1.43", 200),
            ("1.43", 200),
            ("1.43", 100),
            ("3.19", "62.5"),
            ("8.21", 100),
            ("4.08", 100),
            ("2.50", 187),
            ("52.84", 200),
            ("5.16", 1000),
            ("6.91", 1000),
        ],
        ".28 2.04 4.17 5.60 7.03 8.46 13.41 23.38 27.46 29.96 98.59 123.03 134.89".split(),
    ),
    "Ada application on a microcontroller, without overheads": (
        [("0.01", 5000), ("482.59", 1000), ("312.34", 3000), ("198.64", 3000)],
        ["0.01", "482.60", "794.94", "993.58"],
    ),
}

NOT_GIVEN = None


def _row(text: str) -> tuple[str, list[Fraction | None]]:
    name, *numbers = text.split()
    return name, [NOT_GIVEN if number == "-" else Fraction(number) for number in numbers]


# Attitude control software of the Herschel and Planck satellites, in ms, most urgent first:
# T, C, D, stated B, bound of the builder's analysis, worst case found by model checking with
# execution times at their bounds (both: Mikucionis et al., ISoLA 2010), bound computed here from
# the first four.
HERSCHEL = [
    _row(line)
    for line in """
RTEMS_RTC 10.000 0.013 1.000 0.035 0.050 0.013 0.048
AswSync_SyncPulseIsr 250.000 0.070 1.000 0.035 0.120 0.083 0.118
Hk_SamplerIsr 125.000 0.070 1.000 0.035 0.120 0.070 0.188
SwCyc_CycStartIsr 250.000 0.200 1.000 0.035 0.320 0.103 0.388
SwCyc_CycEndIsr 250.000 0.100 1.000 0.035 0.220 0.113 0.488
Rt1553_Isr 15.625 0.070 1.000 0.035 0.290 0.173 0.558
Bc1553_Isr 20.000 0.070 1.000 0.035 0.360 0.243 0.628
Spw_Isr 39.000 0.070 2.000 0.035 0.430 0.313 0.698
Obdh_Isr 250.000 0.070 2.000 0.035 0.500 0.383 0.768
RtSdb_P_1 15.625 0.150 15.625 3.650 4.330 0.533 4.533
RtSdb_P_2 125.000 0.400 15.625 3.650 4.870 0.933 4.933
RtSdb_P_3 250.000 0.170 15.625 3.650 5.110 1.103 5.103
FdirEvents 250.000 5.000 230.220 0.720 7.180 5.153 7.173
NominalEvents_1 250.000 0.720 230.220 0.720 7.900 5.873 7.893
MainCycle 250.000 0.400 230.220 0.720 8.370 6.273 8.293
HkSampler_P_2 125.000 0.500 62.500 3.650 - - -
HkSampler_P_1 250.000 6.000 62.500 3.650 - - -
Acb_P 250.000 6.000 50.000 3.650 - - -
IoCyc_P 250.000 3.000 50.000 3.650 - - -
PrimaryF 250.000 34.050 59.600 5.770 65.5 54.1 -
RCSControlF 250.000 4.070 239.600 12.120 - - -
Obt_P 1000.000 1.100 100.000 9.630 - - -
Hk_P 250.000 2.750 250.000 1.035 - - -
StsMon_P 250.000 3.300 125.000 16.070 - - -
TmGen_P 250.000 4.860 250.000 4.260 - - -
Sgm_P 250.000 4.020 250.000 1.040 - - -
TcRouter_P 250.000 0.500 250.000 1.035 - - -
Cmd_P 250.000 14.000 250.000 26.110 114.920 94.346 120.159
NominalEvents_2 250.000 1.780 230.220 12.480 102.760 65.177 107.923
SecondaryF_1 250.000 20.960 189.600 27.650 141.550 110.666 145.945
SecondaryF_2 250.000 39.690 230.220 48.450 204.050 154.556 207.743
Bkgnd_P 250.000 0.200 250.000 0.000 154.090 15.046 158.488
""".strip().splitlines()
]

# First arrivals in the published model, in ms; all others arrive at 0. Spw_Isr is left without a
# phase, since its period of 39 ms would repeat with the others after 39 s only.
HERSCHEL_PHASES = {
    "Hk_SamplerIsr": "62.5",
    "SwCyc_CycEndIsr": "200",
    "FdirEvents": "20",
    "NominalEvents_1": "20",
    "MainCycle": "20",
    "HkSampler_P_2": "62.5",
    "HkSampler_P_1": "62.5",
    "Acb_P": "200",
    "IoCyc_P": "200",
    "PrimaryF": "20",
    "RCSControlF": "20",
    "StsMon_P": "62.5",
    "NominalEvents_2": "20",
    "SecondaryF_1": "20",
    "SecondaryF_2": "20",
}
