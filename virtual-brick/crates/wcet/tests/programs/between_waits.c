/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors
 * SPDX-License-Identifier: Apache-2.0
 *
 * Bodies of tasks that execute more than their jobs, each with the longest of that between two
 * waits as a function of its own. A job takes longer than all of it.
 */

#define FUNCTION __attribute__((noinline))

volatile int places[8];

FUNCTION void wait(void)
{
    places[0] = 0;
}

FUNCTION int works(int times)
{
    int sum = 0;
    for (int count = 0; count < times; count++)
        sum += places[count & 7];
    return sum;
}

/* It asks until there is an answer; a wait comes before each look, so no pass is without one. */
FUNCTION int asks(int question)
{
    places[1] = question + works(20);
    do {
        wait();
        places[2] = works(30);
    } while (places[3] == question);
    return places[4];
}

FUNCTION int sets_up(void)
{
    int sum = works(90);
    wait();
    while (places[5])
        sum += asks(1) + asks(2);
    return sum + works(10);
}

/* Between two questions: the end of one and the beginning of the next. */
FUNCTION int sets_up_seen(void)
{
    places[2] = works(30);
    places[1] = works(20);
    wait();
    return 0;
}

void set_up_first(void)
{
    places[6] = sets_up();
    for (;;) {
        wait();
        places[6] = works(300);
    }
}

/* Behind the set-up: its last look and what the task does before its own wait. */
FUNCTION int set_up_long_seen(void)
{
    places[2] = works(30);
    int sum = works(10);
    places[6] = sum;
    places[6] = works(70);
    wait();
    return 0;
}

void set_up_long(void)
{
    places[6] = sets_up();
    places[6] = works(70);
    for (;;) {
        wait();
        places[6] = works(300);
    }
}

/* A search that a job leads to: the job's first part and the beginning of a question. */
FUNCTION int searches(void)
{
    return asks(3);
}

FUNCTION int leads_to_search_seen(void)
{
    places[6] = works(80);
    places[1] = works(20);
    wait();
    return 0;
}

void leads_to_search(void)
{
    for (;;) {
        wait();
        places[6] = works(80);
        if (places[7])
            places[6] = searches();
        else
            places[6] = works(300);
    }
}

/* What never waits belongs to the job in which it is executed, which has no deadline then. */
FUNCTION int repairs(void)
{
    return works(200);
}

FUNCTION int without_a_wait_seen(void)
{
    places[6] = works(5);
    places[6] = repairs();
    places[6] = works(8);
    wait();
    return 0;
}

void without_a_wait(void)
{
    for (;;) {
        wait();
        places[6] = works(5);
        if (places[7])
            places[6] = repairs();
        else
            places[6] = works(300);
        places[6] = works(8);
    }
}

void only_jobs(void)
{
    for (;;) {
        wait();
        places[6] = works(300);
    }
}

/* A pass of this loop need not wait. */
FUNCTION void looks_often(void)
{
    while (places[5])
        if (places[7])
            wait();
}

void looks(void)
{
    for (;;) {
        looks_often();
        wait();
    }
}

int main(void)
{
    return sets_up_seen() + set_up_long_seen() + leads_to_search_seen() + without_a_wait_seen();
}
