/* What a firmware engineer writes to land A1 and for the dynamics of both robots, and what wrong use brings.
 *
 * Builds with any C11 compiler; runs on a PC and, with newlib's semihosting, on a Cortex-M7. Every number is printed by
 * its bits, so that two machines can be compared. Ends with 0 if everything is as the header says. */
#include "check.h"

static _Alignas(16) unsigned char landing[32 * 1024];
static _Alignas(16) unsigned char moved[32 * 1024];
static SaltusA1State a1;
static SaltusA1Command command;
static SaltusIcubState icub;
static double mass[18][18], icub_mass[29][29];
static const double IDENTITY[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

/* Forward dynamics undoes inverse dynamics. */
static void undone(const double *back, const double *acceleration, int count) {
    for (int i = 0; i < count; ++i) {
        double error = back[i] - acceleration[i];
        hold("forward dynamics does not undo inverse dynamics", error < 1e-8 && error > -1e-8);
    }
}

static void land(void) {
    static const uint8_t contacts[4] = {1, 1, 0, 1};
    SaltusA1Target target = {.height = 0.25};
    hold("room for the landing", saltus_a1_landing_size() <= sizeof landing && saltus_a1_landing_align() <= 16);
    memcpy(target.rotation_wb, IDENTITY, sizeof IDENTITY);
    memcpy(a1.rotation_wb, IDENTITY, sizeof IDENTITY);
    a1.position_w[2] = 0.26;
    a1.linear_velocity_b[2] = -1.2;
    a1.angular_velocity_b[1] = 0.4;
    for (int leg = 0; leg < 4; ++leg) {
        a1.joints[3 * leg + 1] = target.waiting[3 * leg + 1] = 0.8;
        a1.joints[3 * leg + 2] = target.waiting[3 * leg + 2] = -1.6;
    }
    expect("landing before init", saltus_a1_landing_step(landing, &a1, contacts, &target, &command), SALTUS_STATUS_NOT_INITIALISED);
    expect("init of nothing", saltus_a1_landing_init(NULL, sizeof landing, SALTUS_VERSION), SALTUS_STATUS_NULL_POINTER);
    expect("init unaligned", saltus_a1_landing_init(landing + 1, sizeof landing - 1, SALTUS_VERSION), SALTUS_STATUS_MISALIGNED);
    expect("init in too little", saltus_a1_landing_init(landing, saltus_a1_landing_size() - 1, SALTUS_VERSION), SALTUS_STATUS_TOO_SMALL);
    expect("init of another version", saltus_a1_landing_init(landing, sizeof landing, SALTUS_VERSION + 1), SALTUS_STATUS_WRONG_VERSION);
    expect("init", saltus_a1_landing_init(landing, sizeof landing, SALTUS_VERSION), SALTUS_STATUS_OK);
    memcpy(moved, landing, sizeof landing);
    expect("a moved block", saltus_a1_landing_step(moved, &a1, contacts, &target, &command), SALTUS_STATUS_NOT_INITIALISED);
    expect("another controller's block", saltus_a1_machine_phase(landing, &(SaltusPhase){SALTUS_PHASE_HOLD}), SALTUS_STATUS_NOT_INITIALISED);
    expect("no state", saltus_a1_landing_step(landing, NULL, contacts, &target, &command), SALTUS_STATUS_NULL_POINTER);
    expect("no command", saltus_a1_landing_step(landing, &a1, contacts, &target, NULL), SALTUS_STATUS_NULL_POINTER);
    SaltusA1State bad = a1;
    bad.joints[3] = 0.0 / (bad.joints[0] - a1.joints[0]);
    expect("not a number", saltus_a1_landing_step(landing, &bad, contacts, &target, &command), SALTUS_STATUS_BAD_DATA);
    hold("bad data did not give the safe command", command.feed_forward[1] == 0 && command.damping[1] > 0);
    bad = a1;
    bad.rotation_wb[0] = 2;
    expect("no rotation", saltus_a1_landing_step(landing, &bad, contacts, &target, &command), SALTUS_STATUS_BAD_DATA);
    for (int tick = 0; tick < 3; ++tick) {
        expect("landing", saltus_a1_landing_step(landing, &a1, contacts, &target, &command), SALTUS_STATUS_OK);
    }
    print("landing", command.feed_forward, 12);
    double tau[12];
    expect("joint PD", saltus_a1_joint_pd(&command, a1.joints, a1.joint_velocities, tau), SALTUS_STATUS_OK);
    print("joint-pd", tau, 12);
    SaltusA1Reference reference = {.torques = {1, 2, 3}};
    memcpy(reference.joints, a1.joints, sizeof reference.joints);
    expect("Cartesian PD", saltus_a1_cartesian_pd(&a1, &reference, &command), SALTUS_STATUS_OK);
    print("cartesian-pd", command.feed_forward, 12);
    expect("mass matrix", saltus_a1_mass_matrix(&a1, mass[0]), SALTUS_STATUS_OK);
    print("mass", mass[0], 18);
    double acceleration[18] = {0}, effort[18], back[18];
    acceleration[2] = 1;
    expect("inverse dynamics", saltus_a1_inverse_dynamics(&a1, acceleration, effort), SALTUS_STATUS_OK);
    expect("forward dynamics", saltus_a1_forward_dynamics(&a1, effort, back), SALTUS_STATUS_OK);
    undone(back, acceleration, 18);
    print("inverse-dynamics", effort, 18);
}

/* A number between -1 and 1: the next of a stream. */
static double next(void) {
    static uint32_t stream = 1;
    stream = stream * 1664525u + 1013904223u;
    return (double)(stream >> 8) / 8388608.0 - 1.0;
}

/* States that no landing visits, until the program takes longer than a tick may: its last iterate is a command all the same. */
static void land_badly(void) {
    SaltusA1Target target = {.height = 0.25};
    memcpy(target.rotation_wb, IDENTITY, sizeof IDENTITY);
    for (int attempt = 0; attempt < 2000; ++attempt) {
        for (int i = 0; i < 12; ++i) {
            a1.joints[i] = 1.5 * next();
            a1.joint_velocities[i] = 20 * next();
        }
        for (int i = 0; i < 3; ++i) {
            a1.linear_velocity_b[i] = 6 * next();
            a1.angular_velocity_b[i] = 6 * next();
        }
        const uint8_t contacts[4] = {1, 1, (uint8_t)(attempt & 1), 1};
        SaltusStatus status = saltus_a1_landing_step(landing, &a1, contacts, &target, &command);
        if (status == SALTUS_STATUS_NOT_SOLVED) {
            print("capped", command.feed_forward, 12);
            return;
        }
        expect("landing anyhow", status, SALTUS_STATUS_OK);
    }
    hold("no landing was ended by its cap", 0);
}

static void icub_dynamics(void) {
    SaltusIcubJump jump;
    expect("iCub's squat", saltus_icub_jump(0.04, &jump), SALTUS_STATUS_OK);
    memcpy(icub.joints, jump.start_joints, sizeof icub.joints);
    memcpy(icub.rotation_wb, IDENTITY, sizeof IDENTITY);
    icub.position_w[2] = 0.4;
    double acceleration[29] = {[2] = 1, [10] = -3}, effort[29], back[29];
    expect("iCub's inverse dynamics", saltus_icub_inverse_dynamics(&icub, acceleration, effort), SALTUS_STATUS_OK);
    expect("iCub's forward dynamics", saltus_icub_forward_dynamics(&icub, effort, back), SALTUS_STATUS_OK);
    undone(back, acceleration, 29);
    expect("iCub's mass matrix", saltus_icub_mass_matrix(&icub, icub_mass[0]), SALTUS_STATUS_OK);
    print("icub-mass", icub_mass[0], 29);
    effort[3] = 0.0 / (icub_mass[0][1] - icub_mass[1][0]);
    expect("an effort of no number", saltus_icub_forward_dynamics(&icub, effort, back), SALTUS_STATUS_BAD_DATA);
}

int main(void) {
    if (saltus_version() != SALTUS_VERSION) {
        puts("wrong: header and library are of different versions");
        return 1;
    }
    land();
    land_badly();
    icub_dynamics();
    printf("blocks A1 landing %lu\n", (unsigned long)saltus_a1_landing_size());
    puts(failures == 0 ? "c-abi: all as the header says" : "c-abi: FAILED");
    return failures == 0 ? 0 : 1;
}
