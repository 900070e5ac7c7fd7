/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors
   SPDX-License-Identifier: Apache-2.0 */
/* mGBA's ARM core, from the library that Debian packages, over 64 KiB of memory without waits.
   Arguments: file with the memory's contents, address of the first instruction, address of the
   result; all in the memory at 0x200000. Runs to the first SWI in ARM state and prints processor
   seconds and the result. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <mgba/internal/arm/arm.h>
#include <mgba/internal/arm/isa-inlines.h>

#define BYTES 0x10000u
#define SLICE_CYCLES 0x10000000

static _Alignas(16) uint8_t ram[BYTES];
static struct ARMCore core;
static int finished;

static inline void *at(uint32_t address, uint32_t size)
{
    return ram + (address & (BYTES - size));
}

static void charge(int *cycles, int count)
{
    if (cycles)
        *cycles += count;
}

static uint32_t load32(struct ARMCore *cpu, uint32_t address, int *cycles)
{
    (void)cpu;
    charge(cycles, 2);
    return *(uint32_t *)at(address, 4);
}

static uint32_t load16(struct ARMCore *cpu, uint32_t address, int *cycles)
{
    (void)cpu;
    charge(cycles, 2);
    return *(uint16_t *)at(address, 2);
}

static uint32_t load8(struct ARMCore *cpu, uint32_t address, int *cycles)
{
    (void)cpu;
    charge(cycles, 2);
    return *(uint8_t *)at(address, 1);
}

static void store32(struct ARMCore *cpu, uint32_t address, int32_t value, int *cycles)
{
    (void)cpu;
    charge(cycles, 1);
    *(int32_t *)at(address, 4) = value;
}

static void store16(struct ARMCore *cpu, uint32_t address, int16_t value, int *cycles)
{
    (void)cpu;
    charge(cycles, 1);
    *(int16_t *)at(address, 2) = value;
}

static void store8(struct ARMCore *cpu, uint32_t address, int8_t value, int *cycles)
{
    (void)cpu;
    charge(cycles, 1);
    *(int8_t *)at(address, 1) = value;
}

/* The lowest address that a list of `count` registers uses. */
static uint32_t lowest(uint32_t base, int count, enum LSMDirection direction)
{
    uint32_t start = direction & LSM_D ? base - 4u * (uint32_t)count : base;
    int skips = (direction & LSM_B ? 1 : 0) != (direction & LSM_D ? 1 : 0);
    return skips ? start + 4 : start;
}

static uint32_t moved(uint32_t base, int count, enum LSMDirection direction)
{
    uint32_t size = 4u * (uint32_t)count;
    return direction & LSM_D ? base - size : base + size;
}

static uint32_t load_multiple(struct ARMCore *cpu, uint32_t base, int mask,
                              enum LSMDirection direction, int *cycles)
{
    int count = __builtin_popcount((unsigned)mask);
    uint32_t address = lowest(base, count, direction);
    for (unsigned list = (unsigned)mask; list; list &= list - 1, address += 4)
        cpu->gprs[__builtin_ctz(list)] = *(int32_t *)at(address, 4);
    charge(cycles, count + 1);
    return moved(base, count, direction);
}

static uint32_t store_multiple(struct ARMCore *cpu, uint32_t base, int mask,
                               enum LSMDirection direction, int *cycles)
{
    int count = __builtin_popcount((unsigned)mask);
    uint32_t address = lowest(base, count, direction);
    for (unsigned list = (unsigned)mask; list; list &= list - 1, address += 4)
        *(int32_t *)at(address, 4) = cpu->gprs[__builtin_ctz(list)];
    charge(cycles, count);
    return moved(base, count, direction);
}

static void set_active_region(struct ARMCore *cpu, uint32_t address)
{
    (void)address;
    cpu->memory.activeRegion = (const uint32_t *)(const void *)ram;
    cpu->memory.activeMask = BYTES - 1;
}

/* Internal cycles of a multiplication. */
static int32_t stall(struct ARMCore *cpu, int32_t count)
{
    (void)cpu;
    return count;
}

/* Also called after a change of state, which ends the core's inner loop. */
static void process_events(struct ARMCore *cpu)
{
    cpu->cycles = 0;
    cpu->nextEvent = SLICE_CYCLES;
}

static void finish(struct ARMCore *cpu, int number)
{
    (void)number;
    finished = 1;
    cpu->nextEvent = cpu->cycles;
}

static void refuse(struct ARMCore *cpu, uint32_t opcode)
{
    fprintf(stderr, "opcode %08x at %08x\n", opcode, (unsigned)cpu->gprs[ARM_PC]);
    exit(1);
}

static void break_point(struct ARMCore *cpu, int number)
{
    refuse(cpu, (uint32_t)number);
}

static void nothing(struct ARMCore *cpu)
{
    (void)cpu;
}

static void start_component(void *cpu, struct mCPUComponent *component)
{
    (void)cpu;
    (void)component;
}

static struct mCPUComponent owner = {.init = start_component};

static void connect(void)
{
    struct ARMMemory *memory = &core.memory;
    memory->load32 = load32;
    memory->load16 = load16;
    memory->load8 = load8;
    memory->store32 = store32;
    memory->store16 = store16;
    memory->store8 = store8;
    memory->loadMultiple = load_multiple;
    memory->storeMultiple = store_multiple;
    memory->stall = stall;
    memory->setActiveRegion = set_active_region;
    core.irqh = (struct ARMInterruptHandler){
        .reset = nothing,
        .processEvents = process_events,
        .swi16 = finish,
        .swi32 = finish,
        .hitIllegal = refuse,
        .bkpt16 = break_point,
        .bkpt32 = break_point,
        .readCPSR = nothing,
        .hitStub = refuse,
    };
}

int main(int count, char **arguments)
{
    FILE *file = count == 4 ? fopen(arguments[1], "rb") : NULL;
    if (!file || fread(ram, 1, BYTES, file) != BYTES) {
        fprintf(stderr, "expected a file of %u bytes and two addresses\n", BYTES);
        return 2;
    }
    fclose(file);
    ARMSetComponents(&core, &owner, 0, NULL);
    ARMInit(&core);
    connect();
    ARMReset(&core);
    core.gprs[ARM_PC] = (int32_t)strtoul(arguments[2], NULL, 0);
    ARMWritePC(&core);
    clock_t start = clock();
    while (!finished)
        ARMRunLoop(&core);
    double seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
    printf("%.6f %u\n", seconds, *(uint32_t *)at((uint32_t)strtoul(arguments[3], NULL, 0), 4));
    return 0;
}
