# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0

# The cross tools and the flags that every unit for the brick is compiled with

ADA := arm-linux-gnueabi-gcc-12
CC  := arm-linux-gnueabi-gcc-12
AR  := arm-linux-gnueabi-ar

MACHINE_FLAGS := -mcpu=arm7tdmi -mfloat-abi=soft -mthumb-interwork -fno-pic \
  -fno-stack-protector -fno-unwind-tables -fno-asynchronous-unwind-tables
