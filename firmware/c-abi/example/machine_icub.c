/* iCub's machine and estimator: every status, fault and refusal of theirs is brought about, then a whole jump is walked through.
 *
 * The robot is no simulation: it stands as the jump begins, and after the take-off as it lands. What matters is that a PC and a
 * Cortex-M7 compute the same bits. Ends with 0 if everything is as the header says. */
#include "check.h"

#include <math.h>

/* Most steps of a program's solver in a tick. */
enum { STEPS = 10 };

static _Alignas(16) unsigned char machine[256 * 1024];
static _Alignas(16) unsigned char moved[256 * 1024];
static _Alignas(16) unsigned char estimator[8 * 1024];
static SaltusIcubJump jump;
static SaltusIcubObservation seen;
static SaltusIcubTick tick;
static double clock_now;

/* A machine that stands, has heard once, and stands as the jump begins. */
static void begin_with(uint32_t max_steps) {
    expect("machine init", saltus_icub_machine_init(machine, sizeof machine, SALTUS_VERSION, max_steps), SALTUS_STATUS_OK);
    memset(&seen, 0, sizeof seen);
    memcpy(seen.position_w, jump.position_w, sizeof seen.position_w);
    memcpy(seen.orientation_wb, jump.orientation_wb, sizeof seen.orientation_wb);
    memcpy(seen.joints, jump.start_joints, sizeof seen.joints);
    seen.foot_forces[0] = seen.foot_forces[1] = 162;
    clock_now = 0;
    expect("first tick", saltus_icub_machine_tick(machine, clock_now, &seen, &tick), SALTUS_STATUS_OK);
}

static void begin(void) {
    begin_with(STEPS);
}

static void bad_blocks(void) {
    SaltusPhase phase;
    expect("tick before init", saltus_icub_machine_tick(machine, 0, &seen, &tick), SALTUS_STATUS_NOT_INITIALISED);
    hold("damping without a machine", tick.phase == SALTUS_PHASE_ABORT && tick.command.damping[22] > 0 && tick.command.stiffness[22] == 0);
    expect("init of nothing", saltus_icub_machine_init(NULL, sizeof machine, SALTUS_VERSION, STEPS), SALTUS_STATUS_NULL_POINTER);
    expect("init unaligned", saltus_icub_machine_init(machine + 1, sizeof machine - 1, SALTUS_VERSION, STEPS), SALTUS_STATUS_MISALIGNED);
    expect("init in too little", saltus_icub_machine_init(machine, saltus_icub_machine_size() - 1, SALTUS_VERSION, STEPS), SALTUS_STATUS_TOO_SMALL);
    expect("init of another version", saltus_icub_machine_init(machine, sizeof machine, SALTUS_VERSION - 1, STEPS), SALTUS_STATUS_WRONG_VERSION);
    begin();
    memcpy(moved, machine, sizeof moved);
    expect("a moved machine", saltus_icub_machine_tick(moved, 1, &seen, &tick), SALTUS_STATUS_NOT_INITIALISED);
    expect("an estimator's call", saltus_icub_estimator_update(machine, NULL, 1e-3, &(SaltusIcubEstimate){.fault_index = 0}), SALTUS_STATUS_NOT_INITIALISED);
    expect("another robot's call", saltus_a1_machine_phase(machine, &phase), SALTUS_STATUS_NOT_INITIALISED);
    expect("arm nothing", saltus_icub_machine_arm(NULL, &jump, 1), SALTUS_STATUS_NULL_POINTER);
    expect("arm with nothing", saltus_icub_machine_arm(machine, NULL, 1), SALTUS_STATUS_NULL_POINTER);
    expect("arm with what is crooked", saltus_icub_machine_arm(machine, (const SaltusIcubJump *)(const void *)(moved + 1), 1), SALTUS_STATUS_MISALIGNED);
    expect("tick to nowhere", saltus_icub_machine_tick(machine, 1e-3, &seen, NULL), SALTUS_STATUS_NULL_POINTER);
    expect("tick of a crooked observation", saltus_icub_machine_tick(machine, 1e-3, (const SaltusIcubObservation *)(const void *)(moved + 1), &tick),
           SALTUS_STATUS_MISALIGNED);
    expect("phase to nowhere", saltus_icub_machine_phase(machine, NULL), SALTUS_STATUS_NULL_POINTER);
    expect("phase of nothing", saltus_icub_machine_phase(NULL, &phase), SALTUS_STATUS_NULL_POINTER);
    double q[23] = {0}, qd[23] = {1, -1}, tau[23];
    expect("joint tick of nothing", saltus_icub_machine_joint_tick(NULL, q, qd, 1e-4, tau), SALTUS_STATUS_NULL_POINTER);
    hold("damping torques without a machine", tau[0] == -5 && tau[1] == 5 && tau[2] == 0);
    expect("joint tick without joints", saltus_icub_machine_joint_tick(machine, NULL, qd, 1e-4, tau), SALTUS_STATUS_NULL_POINTER);
    hold("no torques without joints", tau[0] == 0);
}

/* Arms with a jump of which one number was changed. */
static void refuse(const char *what, size_t at, double value) {
    SaltusIcubJump bad = jump;
    SaltusPhase phase;
    memcpy((char *)&bad + at, &value, sizeof value);
    expect(what, saltus_icub_machine_arm(machine, &bad, clock_now + 1), SALTUS_STATUS_BAD_DATA);
    expect("phase", saltus_icub_machine_phase(machine, &phase), SALTUS_STATUS_OK);
    hold("a refused jump changed the machine", phase == SALTUS_PHASE_STAND);
}

static void bad_jumps(void) {
    SaltusIcubJump other;
    expect("a jump to nowhere", saltus_icub_jump(0.04, NULL), SALTUS_STATUS_NULL_POINTER);
    expect("a jump downwards", saltus_icub_jump(-0.04, &other), SALTUS_STATUS_BAD_DATA);
    expect("a jump of no number", saltus_icub_jump(NAN, &other), SALTUS_STATUS_BAD_DATA);
    refuse("no height", offsetof(SaltusIcubJump, height), 0);
    refuse("a displacement of no number", offsetof(SaltusIcubJump, displacement), NAN);
    refuse("a start that is nowhere", offsetof(SaltusIcubJump, position_w) + 8, INFINITY);
    refuse("a quaternion that is too long", offsetof(SaltusIcubJump, orientation_wb) + 24, 2);
    refuse("a joint of no number", offsetof(SaltusIcubJump, start_joints) + 22 * 8, NAN);
    refuse("a landing posture of no number", offsetof(SaltusIcubJump, landing_joints), NAN);
}

/* The next tick aborts with this fault, and joints are damped from then on. */
static void abort_with(const char *what, double later, const SaltusIcubObservation *observation, SaltusFault fault, uint32_t index) {
    expect(what, saltus_icub_machine_tick(machine, clock_now + later, observation, &tick), SALTUS_STATUS_ABORTED);
    hold(what, tick.phase == SALTUS_PHASE_ABORT && tick.fault == fault && tick.fault_index == index);
    hold("damping after an abort", tick.work == SALTUS_WORK_DAMPING && tick.command.damping[0] > 0 && tick.command.feed_forward[0] == 0);
    expect("arm after an abort", saltus_icub_machine_arm(machine, &jump, clock_now + 1), SALTUS_STATUS_NOT_STANDING);
    begin();
}

/* A jump from so far away that the program's numbers are none: it has no answer, the last command stays for 5 ms, and then joints are damped. */
static void unsolved(void) {
    /* A landing posture so far away that the flight's program has no finite numbers. */
    SaltusIcubJump far = jump;
    far.displacement = 1e-3;
    far.landing_joints[3] = 1e308;
    begin();
    expect("arm for a far posture", saltus_icub_machine_arm(machine, &far, clock_now + 1e-3), SALTUS_STATUS_OK);
    while (tick.phase != SALTUS_PHASE_FLIGHT && clock_now < 0.02) {
        clock_now += 1e-3;
        expect("push-off", saltus_icub_machine_tick(machine, clock_now, &seen, &tick), SALTUS_STATUS_OK);
    }
    for (int i = 0; i < 4; ++i) {
        clock_now += 1e-3;
        expect("no answer", saltus_icub_machine_tick(machine, clock_now, &seen, &tick), SALTUS_STATUS_OK);
        hold("no answer", tick.work == SALTUS_WORK_UNSOLVED && isfinite(tick.command.feed_forward[3]));
    }
    abort_with("no answer for 6 ms", 1e-3, &seen, SALTUS_FAULT_UNSOLVED, 0);
}

static void faults(void) {
    double qd[23] = {0}, tau[23];
    begin();
    seen.joints[14] = NAN;
    abort_with("an encoder that fails", 1e-3, &seen, SALTUS_FAULT_JOINT, 14);
    memset(seen.orientation_wb, 0, sizeof seen.orientation_wb);
    abort_with("a quaternion of zeros", 1e-3, &seen, SALTUS_FAULT_BASE, 0);
    seen.position_w[1] = INFINITY;
    abort_with("a base far away", 1e-3, &seen, SALTUS_FAULT_BASE, 0);
    seen.foot_forces[1] = NAN;
    abort_with("a sole that fails", 1e-3, &seen, SALTUS_FAULT_FOOT, 1);
    seen.age = 1;
    abort_with("an old observation", 1e-3, &seen, SALTUS_FAULT_STALE, 0);
    abort_with("a clock that stands", 0, &seen, SALTUS_FAULT_CLOCK, 0);
    abort_with("a clock of no number", NAN, &seen, SALTUS_FAULT_CLOCK, 0);
    abort_with("a tick after 6 ms", 6e-3, &seen, SALTUS_FAULT_SILENT, 0);
    for (int i = 0; i < 9; ++i) {
        clock_now += 1e-3;
        expect("no news", saltus_icub_machine_tick(machine, clock_now, NULL, &tick), SALTUS_STATUS_OK);
    }
    abort_with("no news for 11 ms", 2e-3, NULL, SALTUS_FAULT_STALE, 0);
    SaltusStatus status = SALTUS_STATUS_OK;
    for (int i = 0; i < 51; ++i) {
        status = saltus_icub_machine_joint_tick(machine, seen.joints, qd, 1e-4, tau);
        expect("joint tick", status, i < 50 ? SALTUS_STATUS_OK : SALTUS_STATUS_ABORTED);
    }
    begin();
    expect("joint tick of no time", saltus_icub_machine_joint_tick(machine, seen.joints, qd, NAN, tau), SALTUS_STATUS_ABORTED);
    begin();
    qd[3] = NAN;
    expect("joint tick of a broken encoder", saltus_icub_machine_joint_tick(machine, seen.joints, qd, 1e-4, tau), SALTUS_STATUS_ABORTED);
    hold("finite torques from a broken encoder", tau[3] == 0 && isfinite(tau[4]));
    unsolved();
}

static void refusals(void) {
    begin();
    expect("a start of no number", saltus_icub_machine_arm(machine, &jump, NAN), SALTUS_STATUS_TOO_LATE);
    expect("a start that is past", saltus_icub_machine_arm(machine, &jump, clock_now - 0.1), SALTUS_STATUS_TOO_LATE);
    expect("arm", saltus_icub_machine_arm(machine, &jump, clock_now + 0.02), SALTUS_STATUS_OK);
    expect("arm again", saltus_icub_machine_arm(machine, &jump, clock_now + 0.02), SALTUS_STATUS_NOT_STANDING);
    seen.joints[7] += 0.2;
    while (clock_now < 0.025) {
        clock_now += 1e-3;
        expect("hold", saltus_icub_machine_tick(machine, clock_now, &seen, &tick), SALTUS_STATUS_OK);
    }
    hold("a joint that is not where the jump begins", tick.phase == SALTUS_PHASE_STAND && tick.refusal == SALTUS_REFUSAL_POSTURE && tick.refusal_joint == 7);

    begin();
    SaltusIcubJump elsewhere = jump;
    elsewhere.position_w[0] += 0.1;
    expect("arm for another place", saltus_icub_machine_arm(machine, &elsewhere, clock_now + 0.02), SALTUS_STATUS_OK);
    expect("hold elsewhere", saltus_icub_machine_tick(machine, clock_now + 1e-3, &seen, &tick), SALTUS_STATUS_OK);
    hold("feet that are not where the jump begins", tick.phase == SALTUS_PHASE_STAND && tick.refusal == SALTUS_REFUSAL_PLACE);
}

/* With one step of the solver no program comes to its optimum: what it has is a command all the same. */
static void capped(void) {
    begin_with(1);
    seen.joint_velocities[3] = 20;
    expect("tick", saltus_icub_machine_tick(machine, 1e-3, &seen, &tick), SALTUS_STATUS_OK);
    hold("a capped landing", tick.work == SALTUS_WORK_LANDING_CAPPED);
    print("capped landing", tick.command.feed_forward, 23);
    expect("arm", saltus_icub_machine_arm(machine, &jump, 1), SALTUS_STATUS_OK);
    expect("tick", saltus_icub_machine_tick(machine, 2e-3, &seen, &tick), SALTUS_STATUS_OK);
    hold("a capped push-off", tick.work == SALTUS_WORK_PUSH_OFF_CAPPED);
    print("capped push-off", tick.command.feed_forward, 23);
}

static void estimates(void) {
    SaltusIcubStart start = {.imu_orientation_bi = {0, 0, 0, 1}};
    SaltusIcubSample sample = {.specific_force_i = {0.1, 0, 9.81}, .angular_velocity_i = {0, 0.2, 0}, .evidence = {1, 0}}, bad;
    SaltusIcubEstimate found;
    memcpy(start.joints, jump.start_joints, sizeof start.joints);
    memcpy(start.position_w, jump.position_w, sizeof start.position_w);
    memcpy(sample.joints, jump.start_joints, sizeof sample.joints);
    hold("room for the estimator", saltus_icub_estimator_size() <= sizeof estimator && saltus_icub_estimator_align() <= 16);
    expect("estimate before init", saltus_icub_estimator_update(estimator, &sample, 1e-3, &found), SALTUS_STATUS_NOT_INITIALISED);
    hold("lost without an estimator", found.status == SALTUS_ESTIMATE_STATUS_LOST);
    expect("a start turned nowhere", saltus_icub_estimator_init(estimator, sizeof estimator, SALTUS_VERSION, &start), SALTUS_STATUS_BAD_DATA);
    memcpy(start.orientation_wb, jump.orientation_wb, sizeof start.orientation_wb);
    expect("estimator in too little", saltus_icub_estimator_init(estimator, 8, SALTUS_VERSION, &start), SALTUS_STATUS_TOO_SMALL);
    expect("estimator", saltus_icub_estimator_init(estimator, sizeof estimator, SALTUS_VERSION, &start), SALTUS_STATUS_OK);
    expect("another robot's estimate", saltus_a1_estimator_update(estimator, NULL, 1e-3, &(SaltusA1Estimate){.fault_index = 0}), SALTUS_STATUS_NOT_INITIALISED);
    Cost most = {0, 0};
    for (int i = 0; i < 50; ++i) {
        unsigned long since = begin_cost();
        SaltusStatus status = saltus_icub_estimator_update(estimator, &sample, 1e-3, &found);
        end_cost(&most, since);
        expect("estimate", status, SALTUS_STATUS_OK);
    }
    hold("a good estimate", found.status == SALTUS_ESTIMATE_STATUS_GOOD && found.fault == SALTUS_SAMPLE_FAULT_NONE);
    print("estimate", found.position_w, 3);
    print("estimate", found.orientation_wb, 4);
    print("estimate", found.linear_velocity_b, 3);
    print("estimate", found.confidence, 2);
    print_cost("iCub", "estimate", most);
    bad = sample;
    bad.joints[11] = NAN;
    expect("a wrong sample", saltus_icub_estimator_update(estimator, &bad, 1e-3, &found), SALTUS_STATUS_OK);
    hold("a wrong sample", found.fault == SALTUS_SAMPLE_FAULT_JOINT && found.fault_index == 11 && isfinite(found.position_w[0]));
    for (int i = 0; i < 30; ++i) {
        expect("no sample", saltus_icub_estimator_update(estimator, NULL, 1e-3, &found), SALTUS_STATUS_OK);
        hold("no sample", found.fault == SALTUS_SAMPLE_FAULT_MISSING);
    }
    hold("lost after 30 ms", found.status == SALTUS_ESTIMATE_STATUS_LOST);
}

/* All phases of the jump, from standing to standing; digests of what the machine says. */
static void walk(void) {
    Cost most[SALTUS_PHASE_ABORT + 1] = {{0, 0}}, joint = {0, 0}, arm = {0, 0};
    int visited[SALTUS_PHASE_ABORT + 1] = {0};
    double tau[23];
    begin();
    unsigned long since = begin_cost();
    SaltusStatus status = saltus_icub_machine_arm(machine, &jump, 0.1);
    end_cost(&arm, since);
    expect("arm", status, SALTUS_STATUS_OK);
    print_cost("iCub", "arm", arm);
    for (int k = 1; k < 2000 && visited[SALTUS_PHASE_STAND] < 20; ++k) {
        clock_now = 1e-3 * k;
        Cost cost = {0, 0};
        since = begin_cost();
        status = saltus_icub_machine_tick(machine, clock_now, &seen, &tick);
        end_cost(&cost, since);
        expect("walk", status, SALTUS_STATUS_OK);
        most[tick.phase] = larger(most[tick.phase], cost);
        since = begin_cost();
        status = saltus_icub_machine_joint_tick(machine, seen.joints, seen.joint_velocities, 1e-4, tau);
        end_cost(&joint, since);
        expect("walk", status, SALTUS_STATUS_OK);
        ++visited[tick.phase];
        hold("a program's work", tick.work == (tick.phase <= SALTUS_PHASE_STANCE ? SALTUS_WORK_PUSH_OFF : SALTUS_WORK_LANDING)
                                     || tick.work == SALTUS_WORK_LANDING_CAPPED || tick.work == SALTUS_WORK_PUSH_OFF_CAPPED);
        take(&tick.command, sizeof tick.command);
        take(tau, sizeof tau);
        take(&tick.iterations, sizeof tick.iterations);
        take(&(uint32_t){(uint32_t)tick.yielded}, sizeof(uint32_t)); /* An enum has another size on the board. */
        if (k % 10 == 0) {
            print_digest(tick.phase);
        }
        /* Off the ground from the take-off on, until it has fallen for 20 ms. */
        int flies = tick.phase == SALTUS_PHASE_FLIGHT || (tick.phase == SALTUS_PHASE_PRE_LANDING && visited[tick.phase] < 20);
        seen.foot_forces[0] = seen.foot_forces[1] = flies ? 0 : 162;
        if (flies) {
            memcpy(seen.joints, jump.landing_joints, sizeof seen.joints);
        }
    }
    for (int phase = SALTUS_PHASE_HOLD; phase <= SALTUS_PHASE_STAND; ++phase) {
        hold(saltus_phase_text((uint32_t)phase), visited[phase] > 0);
        print_cost("iCub", saltus_phase_text((uint32_t)phase), most[phase]);
    }
    print_cost("iCub", "joint tick", joint);
}

/* What initialising takes of the stack, where the programs' memory may be made before it is moved into the block. */
static void init_cost(void) {
    static const size_t watched = 1024 * 1024;
    paint_stack(watched);
    expect("machine init", saltus_icub_machine_init(machine, sizeof machine, SALTUS_VERSION, 0), SALTUS_STATUS_OK);
    printf("costs iCub init, bytes of stack %lu\n", stack_used(watched));
}

int main(void) {
    expect("jump", saltus_icub_jump(0.04, &jump), SALTUS_STATUS_OK);
    if (saltus_icub_machine_size() > sizeof machine || saltus_icub_machine_align() > 16) {
        printf("c-abi: no room for the machine of %lu bytes\n", (unsigned long)saltus_icub_machine_size());
        return 1;
    }
    bad_blocks();
    bad_jumps();
    faults();
    refusals();
    capped();
    estimates();
    init_cost();
    walk();
    printf("blocks iCub machine %lu estimator %lu\n", (unsigned long)saltus_icub_machine_size(), (unsigned long)saltus_icub_estimator_size());
    puts(failures == 0 ? "c-abi: all as the header says" : "c-abi: FAILED");
    return failures == 0 ? 0 : 1;
}
