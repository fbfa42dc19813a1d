/* A1's machine and estimator: every status, fault and refusal that the header names is brought about, then a whole plan is walked through.
 *
 * The robot is no simulation: it stands as the plan begins, and is seen standing there all the time. What matters is that a PC and a
 * Cortex-M7 compute the same bits. Ends with 0 if everything is as the header says. */
#include "check.h"

#include <math.h>
#include <stdlib.h>

extern const uint8_t plan_begin[], plan_end[];

static _Alignas(16) unsigned char machine[64 * 1024];
static _Alignas(16) unsigned char moved[32 * 1024];
static _Alignas(16) unsigned char estimator[8 * 1024];
static uint8_t broken[512 * 1024];
static size_t length;
static SaltusA1Plan about;
static SaltusA1Observation seen;
static SaltusA1Tick tick;
static double clock_now;

/* A machine that stands, has heard once, and stands as the plan begins. */
static void begin(void) {
    expect("machine init", saltus_a1_machine_init(machine, sizeof machine, SALTUS_VERSION), SALTUS_STATUS_OK);
    memset(&seen, 0, sizeof seen);
    memcpy(seen.position_w, about.start_position_w, sizeof seen.position_w);
    memcpy(seen.orientation_wb, about.start_orientation_wb, sizeof seen.orientation_wb);
    memcpy(seen.joints, about.start_joints, sizeof seen.joints);
    for (int foot = 0; foot < 4; ++foot) {
        seen.foot_forces[foot] = about.weight / 4;
    }
    clock_now = 0;
    expect("first tick", saltus_a1_machine_tick(machine, clock_now, &seen, &tick), SALTUS_STATUS_OK);
}

/* CRC-32 of the plan without its checksum, which it then writes there. */
static void seal(void) {
    uint32_t crc = 0xffffffffu;
    for (size_t i = 0; i < length; ++i) {
        if (i >= 20 && i < 24) {
            continue;
        }
        crc ^= broken[i];
        for (int bit = 0; bit < 8; ++bit) {
            crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
        }
    }
    for (int i = 0; i < 4; ++i) {
        broken[20 + i] = (uint8_t)(~crc >> 8 * i);
    }
}

/* Arms with the plan after one byte was changed. */
static void refuse(const char *what, size_t at, uint8_t value, int sealed, SaltusStatus wanted, SaltusCulprit *culprit) {
    memcpy(broken, plan_begin, length);
    broken[at] = value;
    if (sealed) {
        seal();
    }
    expect(what, saltus_a1_machine_arm(machine, broken, length, clock_now + 1, culprit), wanted);
    expect(what, saltus_a1_plan_read(broken, length, &about, NULL), wanted);
    SaltusPhase phase;
    expect("phase", saltus_a1_machine_phase(machine, &phase), SALTUS_STATUS_OK);
    hold("a refused plan changed the machine", phase == SALTUS_PHASE_STAND);
}

static void bad_plans(void) {
    SaltusCulprit culprit;
    const size_t node = 4 * (20 + 3 * 12 + 9 * 4), nodes = 476 + 4 * 12;
    expect("no plan", saltus_a1_machine_arm(machine, NULL, length, 1, &culprit), SALTUS_STATUS_NULL_POINTER);
    expect("a negative length", saltus_a1_machine_arm(machine, plan_begin, (size_t)-1, 1, &culprit), SALTUS_STATUS_TOO_SMALL);
    expect("a cut plan", saltus_a1_machine_arm(machine, plan_begin, length - 1, 1, &culprit), SALTUS_STATUS_PLAN_CUT_OFF);
    hold("lengths of a cut plan", culprit.found == length - 1 && culprit.expected == length);
    refuse("no plan at all", 0, 'X', 0, SALTUS_STATUS_NOT_A_PLAN, &culprit);
    refuse("another version", 4, 99, 0, SALTUS_STATUS_PLAN_VERSION, &culprit);
    hold("versions", culprit.found == 99 && culprit.expected == 2);
    refuse("a changed byte", 1000, (uint8_t)~plan_begin[1000], 0, SALTUS_STATUS_PLAN_DAMAGED, &culprit);
    refuse("23 joints", 6, 23, 1, SALTUS_STATUS_PLAN_SIZE, &culprit);
    hold("sizes", culprit.found == 23 * 256 + 4 && culprit.expected == 12 * 256 + 4);
    refuse("another robot", 8, (uint8_t)~plan_begin[8], 1, SALTUS_STATUS_PLAN_ROBOT, &culprit);
    hold("hashes", (culprit.found ^ culprit.expected) == 0xff);
    refuse("an unknown rule for torques", 344, 7, 1, SALTUS_STATUS_PLAN_HEADER, &culprit);
    refuse("a joint that is not finite", nodes + 3 * node + 80 + 3, 0x7f, 1, SALTUS_STATUS_PLAN_VALUE, &culprit);
    hold("the value and its node", strcmp(culprit.what, "joints") == 0 && culprit.node == 3);
    refuse("posing before the take-off", 352 + 3, 0, 1, SALTUS_STATUS_PLAN_VALUE, &culprit);
    hold("the value of the header", strcmp(culprit.what, "posing") == 0 && culprit.node == -1);
    expect("plan to nowhere", saltus_a1_plan_read(plan_begin, length, NULL, &culprit), SALTUS_STATUS_NULL_POINTER);
    expect("plan", saltus_a1_plan_read(plan_begin, length, &about, &culprit), SALTUS_STATUS_OK);
    hold("task", strcmp(about.task, "a1/double-backflip") == 0 && culprit.node == -1 && culprit.what[0] == 0);
}

static void bad_blocks(void) {
    SaltusCulprit culprit;
    SaltusPhase phase;
    expect("tick before init", saltus_a1_machine_tick(machine, 0, &seen, &tick), SALTUS_STATUS_NOT_INITIALISED);
    hold("damping without a machine", tick.phase == SALTUS_PHASE_ABORT && tick.command.damping[5] > 0 && tick.command.stiffness[5] == 0);
    expect("init of nothing", saltus_a1_machine_init(NULL, sizeof machine, SALTUS_VERSION), SALTUS_STATUS_NULL_POINTER);
    expect("init unaligned", saltus_a1_machine_init(machine + 1, sizeof machine - 1, SALTUS_VERSION), SALTUS_STATUS_MISALIGNED);
    expect("init in too little", saltus_a1_machine_init(machine, saltus_a1_machine_size() - 1, SALTUS_VERSION), SALTUS_STATUS_TOO_SMALL);
    expect("init of another version", saltus_a1_machine_init(machine, sizeof machine, SALTUS_VERSION - 1), SALTUS_STATUS_WRONG_VERSION);
    begin();
    memcpy(moved, machine, sizeof moved);
    expect("a moved machine", saltus_a1_machine_tick(moved, 1, &seen, &tick), SALTUS_STATUS_NOT_INITIALISED);
    expect("an estimator's call", saltus_a1_estimator_update(machine, NULL, 1e-3, &(SaltusA1Estimate){.fault_index = 0}), SALTUS_STATUS_NOT_INITIALISED);
    expect("arm nothing", saltus_a1_machine_arm(NULL, plan_begin, length, 1, NULL), SALTUS_STATUS_NULL_POINTER);
    expect("arm, culprit unaligned", saltus_a1_machine_arm(machine, plan_begin, length, 1, (SaltusCulprit *)(void *)((char *)&culprit + 1)),
           SALTUS_STATUS_MISALIGNED);
    expect("tick to nowhere", saltus_a1_machine_tick(machine, 1e-3, &seen, NULL), SALTUS_STATUS_NULL_POINTER);
    expect("tick of a crooked observation", saltus_a1_machine_tick(machine, 1e-3, (const SaltusA1Observation *)(const void *)(moved + 1), &tick),
           SALTUS_STATUS_MISALIGNED);
    expect("phase to nowhere", saltus_a1_machine_phase(machine, NULL), SALTUS_STATUS_NULL_POINTER);
    expect("phase of nothing", saltus_a1_machine_phase(NULL, &phase), SALTUS_STATUS_NULL_POINTER);
    double q[12] = {0}, qd[12] = {1, -1}, tau[12];
    expect("joint tick of nothing", saltus_a1_machine_joint_tick(NULL, q, qd, 1e-4, tau), SALTUS_STATUS_NULL_POINTER);
    hold("damping torques without a machine", tau[0] == -2 && tau[1] == 2 && tau[2] == 0);
    expect("joint tick without joints", saltus_a1_machine_joint_tick(machine, NULL, qd, 1e-4, tau), SALTUS_STATUS_NULL_POINTER);
    hold("no torques without joints", tau[0] == 0);
}

/* The next tick aborts with this fault, and joints are damped from then on. */
static void abort_with(const char *what, double later, const SaltusA1Observation *observation, SaltusFault fault, uint32_t index) {
    expect(what, saltus_a1_machine_tick(machine, clock_now + later, observation, &tick), SALTUS_STATUS_ABORTED);
    hold(what, tick.phase == SALTUS_PHASE_ABORT && tick.fault == fault && tick.fault_index == index);
    hold("damping after an abort", tick.work == SALTUS_WORK_DAMPING && tick.command.damping[0] > 0 && tick.command.feed_forward[0] == 0);
    expect("arm after an abort", saltus_a1_machine_arm(machine, plan_begin, length, clock_now + 1, NULL), SALTUS_STATUS_NOT_STANDING);
    begin();
}

static void faults(void) {
    double qd[12] = {0}, tau[12];
    begin();
    seen.joints[4] = NAN;
    abort_with("an encoder that fails", 1e-3, &seen, SALTUS_FAULT_JOINT, 4);
    memset(seen.orientation_wb, 0, sizeof seen.orientation_wb);
    abort_with("a quaternion of zeros", 1e-3, &seen, SALTUS_FAULT_BASE, 0);
    seen.position_w[1] = INFINITY;
    abort_with("a base far away", 1e-3, &seen, SALTUS_FAULT_BASE, 0);
    seen.foot_forces[2] = NAN;
    abort_with("a foot that fails", 1e-3, &seen, SALTUS_FAULT_FOOT, 2);
    seen.age = 1;
    abort_with("an old observation", 1e-3, &seen, SALTUS_FAULT_STALE, 0);
    abort_with("a clock that stands", 0, &seen, SALTUS_FAULT_CLOCK, 0);
    abort_with("a clock of no number", NAN, &seen, SALTUS_FAULT_CLOCK, 0);
    abort_with("a tick after 6 ms", 6e-3, &seen, SALTUS_FAULT_SILENT, 0);
    for (int i = 0; i < 9; ++i) {
        clock_now += 1e-3;
        expect("no news", saltus_a1_machine_tick(machine, clock_now, NULL, &tick), SALTUS_STATUS_OK);
    }
    abort_with("no news for 11 ms", 2e-3, NULL, SALTUS_FAULT_STALE, 0);
    SaltusStatus status = SALTUS_STATUS_OK;
    for (int i = 0; i < 51; ++i) {
        status = saltus_a1_machine_joint_tick(machine, seen.joints, qd, 1e-4, tau);
        expect("joint tick", status, i < 50 ? SALTUS_STATUS_OK : SALTUS_STATUS_ABORTED);
    }
    begin();
    expect("joint tick of no time", saltus_a1_machine_joint_tick(machine, seen.joints, qd, NAN, tau),
           SALTUS_STATUS_ABORTED);
    begin();
    qd[3] = NAN;
    expect("joint tick of a broken encoder", saltus_a1_machine_joint_tick(machine, seen.joints, qd, 1e-4, tau),
           SALTUS_STATUS_ABORTED);
    hold("finite torques from a broken encoder", tau[3] == 0 && isfinite(tau[4]));
}

static void refusals(void) {
    begin();
    expect("a start of no number", saltus_a1_machine_arm(machine, plan_begin, length, NAN, NULL), SALTUS_STATUS_TOO_LATE);
    expect("a start too near", saltus_a1_machine_arm(machine, plan_begin, length, clock_now + 0.1, NULL), SALTUS_STATUS_TOO_LATE);
    expect("arm", saltus_a1_machine_arm(machine, plan_begin, length, clock_now + 1.2, NULL), SALTUS_STATUS_OK);
    expect("arm again", saltus_a1_machine_arm(machine, plan_begin, length, clock_now + 1.2, NULL), SALTUS_STATUS_NOT_STANDING);
    seen.joints[7] += 0.2;
    while (clock_now < 1.21) {
        clock_now += 1e-3;
        expect("hold", saltus_a1_machine_tick(machine, clock_now, &seen, &tick), SALTUS_STATUS_OK);
    }
    hold("a joint that is not where the plan begins", tick.phase == SALTUS_PHASE_STAND && tick.refusal == SALTUS_REFUSAL_POSTURE && tick.refusal_joint == 7);
}

static void estimates(void) {
    SaltusA1Start start = {.orientation_wb = {0, 0, 0, 1}, .imu_orientation_bi = {0, 0, 0, 1}};
    SaltusA1Sample sample = {.specific_force_i = {0.1, 0, 9.81}, .angular_velocity_i = {0, 0.2, 0}, .evidence = {1, 1, 1, 0}}, bad;
    SaltusA1Estimate found;
    memcpy(start.joints, about.start_joints, sizeof start.joints);
    memcpy(start.position_w, about.start_position_w, sizeof start.position_w);
    memcpy(sample.joints, about.start_joints, sizeof sample.joints);
    hold("room for the estimator", saltus_a1_estimator_size() <= sizeof estimator && saltus_a1_estimator_align() <= 16);
    expect("estimate before init", saltus_a1_estimator_update(estimator, &sample, 1e-3, &found), SALTUS_STATUS_NOT_INITIALISED);
    hold("lost without an estimator", found.status == SALTUS_ESTIMATE_STATUS_LOST);
    expect("estimator at no start", saltus_a1_estimator_init(estimator, sizeof estimator, SALTUS_VERSION, NULL), SALTUS_STATUS_NULL_POINTER);
    start.imu_orientation_bi[3] = 0;
    expect("an IMU that is turned nowhere", saltus_a1_estimator_init(estimator, sizeof estimator, SALTUS_VERSION, &start), SALTUS_STATUS_BAD_DATA);
    start.imu_orientation_bi[3] = 1;
    expect("estimator in too little", saltus_a1_estimator_init(estimator, 8, SALTUS_VERSION, &start), SALTUS_STATUS_TOO_SMALL);
    expect("estimator", saltus_a1_estimator_init(estimator, sizeof estimator, SALTUS_VERSION, &start), SALTUS_STATUS_OK);
    expect("estimate to nowhere", saltus_a1_estimator_update(estimator, &sample, 1e-3, NULL), SALTUS_STATUS_NULL_POINTER);
    Cost most = {0, 0};
    for (int i = 0; i < 50; ++i) {
        unsigned long since = begin_cost();
        SaltusStatus status = saltus_a1_estimator_update(estimator, &sample, 1e-3, &found);
        end_cost(&most, since);
        expect("estimate", status, SALTUS_STATUS_OK);
    }
    hold("a good estimate", found.status == SALTUS_ESTIMATE_STATUS_GOOD && found.fault == SALTUS_SAMPLE_FAULT_NONE);
    print("estimate", found.position_w, 3);
    print("estimate", found.orientation_wb, 4);
    print("estimate", found.linear_velocity_b, 3);
    print("estimate", found.confidence, 4);
    print_cost("A1", "estimate", most);
    static const struct { SaltusSampleFault fault; size_t at; uint32_t index; } wrong[] = {
        {SALTUS_SAMPLE_FAULT_ACCELEROMETER, offsetof(SaltusA1Sample, specific_force_i), 0},
        {SALTUS_SAMPLE_FAULT_GYROSCOPE, offsetof(SaltusA1Sample, angular_velocity_i), 0},
        {SALTUS_SAMPLE_FAULT_JOINT, offsetof(SaltusA1Sample, joints) + 5 * sizeof(double), 5},
        {SALTUS_SAMPLE_FAULT_EVIDENCE, offsetof(SaltusA1Sample, evidence) + 3 * sizeof(double), 3},
    };
    const double nan = NAN;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        bad = sample;
        memcpy((char *)&bad + wrong[i].at, &nan, sizeof nan);
        expect("a wrong sample", saltus_a1_estimator_update(estimator, &bad, 1e-3, &found), SALTUS_STATUS_OK);
        hold(saltus_sample_fault_text((uint32_t)wrong[i].fault), found.fault == wrong[i].fault && found.fault_index == wrong[i].index && isfinite(found.position_w[0]));
    }
    expect("no step", saltus_a1_estimator_update(estimator, &sample, NAN, &found), SALTUS_STATUS_OK);
    hold("a step of no number", found.fault == SALTUS_SAMPLE_FAULT_STEP);
    for (int i = 0; i < 30; ++i) {
        expect("no sample", saltus_a1_estimator_update(estimator, NULL, 1e-3, &found), SALTUS_STATUS_OK);
        hold("no sample", found.fault == SALTUS_SAMPLE_FAULT_MISSING);
    }
    hold("lost after 30 ms", found.status == SALTUS_ESTIMATE_STATUS_LOST);
}

/* All phases of the plan, in the order of time; digests of what the machine says. */
static void walk(void) {
    Cost most[SALTUS_PHASE_ABORT + 1] = {{0, 0}}, joint = {0, 0}, arm = {0, 0};
    int visited[SALTUS_PHASE_ABORT + 1] = {0};
    double tau[12];
    begin();
    unsigned long since = begin_cost();
    SaltusStatus status = saltus_a1_machine_arm(machine, plan_begin, length, 1.2, NULL);
    end_cost(&arm, since);
    expect("arm", status, SALTUS_STATUS_OK);
    print_cost("A1", "arm", arm);
    for (int k = 1; clock_now < 1.2 + about.touchdown + 0.2; ++k) {
        clock_now = 1e-3 * k;
        Cost cost = {0, 0};
        since = begin_cost();
        status = saltus_a1_machine_tick(machine, clock_now, &seen, &tick);
        end_cost(&cost, since);
        expect("walk", status, SALTUS_STATUS_OK);
        most[tick.phase] = larger(most[tick.phase], cost);
        since = begin_cost();
        status = saltus_a1_machine_joint_tick(machine, seen.joints, seen.joint_velocities, 1e-4, tau);
        end_cost(&joint, since);
        expect("walk", status, SALTUS_STATUS_OK);
        if (tick.phase == SALTUS_PHASE_HOLD) {
            memcpy(seen.torques, tau, sizeof tau); /* Of a robot that stands: with any others its feet would not be believed. */
        }
        ++visited[tick.phase];
        take(&tick.command, sizeof tick.command);
        take(tau, sizeof tau);
        if (k % 20 == 0) {
            print_digest(tick.phase);
        }
    }
    for (int phase = SALTUS_PHASE_HOLD; phase <= SALTUS_PHASE_LANDING; ++phase) {
        hold(saltus_phase_text((uint32_t)phase), visited[phase] > 0);
        print_cost("A1", saltus_phase_text((uint32_t)phase), most[phase]);
    }
    print_cost("A1", "joint tick", joint);
}

int main(void) {
    length = (size_t)(plan_end - plan_begin);
    hold("room for the machine", saltus_a1_machine_size() <= sizeof machine && saltus_a1_machine_align() <= 16);
    if (length > sizeof broken) {
        puts("c-abi: no room for a copy of the plan");
        return 1;
    }
    hold("texts", strcmp(saltus_status_text(99), "unknown code") == 0 && strcmp(saltus_fault_text(4), "observation too old") == 0
                      && strcmp(saltus_refusal_text(3), saltus_refusal_text(4)) != 0);
    expect("plan", saltus_a1_plan_read(plan_begin, length, &about, NULL), SALTUS_STATUS_OK);
    bad_blocks();
    bad_plans();
    faults();
    refusals();
    estimates();
    walk();
    printf("blocks A1 machine %lu estimator %lu\n", (unsigned long)saltus_a1_machine_size(), (unsigned long)saltus_a1_estimator_size());
    puts(failures == 0 ? "c-abi: all as the header says" : "c-abi: FAILED");
    return failures == 0 ? 0 : 1;
}
