/* A1 stands, jumps, lands and stands again in MuJoCo, controlled through saltus.h alone: what a program of your own may start from.
 *
 *   fly_a1 FOLDER
 *
 * FOLDER holds plan.bin and scene.xml, as `saltus plan a1/lateral --out FOLDER` writes them. The joint loop runs at 10 kHz, the control loop
 * at 1 kHz. The machine never sees the truth: the base is what the estimator makes of an IMU, encoders and foot sensors; the truth makes
 * the sensors' numbers, and judges. Ends with 0 only if 2 s after the touchdown the robot stands upright, the middle of its feet within
 * 0.10 m of the goal and its heading within 10 degrees. */
#include "saltus.h"

#include <math.h>
#include <mujoco/mujoco.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { JOINTS = 12, FEET = 4, RATIO = 10 };

/* Times, s: standing before the machine is armed, from then to the start, and from the touchdown to the verdict. */
static const double STANDS = 1.0, HOLDS = 1.2, SETTLES = 2.0;
/* Force at which a foot is certainly loaded, N. */
static const double LOADED = 15.0;
static const double DEGREE = 3.14159265358979323846 / 180.0;

static mjModel *model;
static mjData *data;
static int foot_geoms[FEET];
static uint8_t *plan;
static size_t plan_bytes;
static SaltusA1Plan about;
static void *machine, *estimator;

/* What the sensors have gathered since the last millisecond. */
static struct {
    double force_b[3], rate_b[3], torques[JOINTS];
    int count;
} gathered;

static int failed(const char *what, SaltusStatus status) {
    if (status != SALTUS_STATUS_OK) {
        printf("%s: %s\n", what, saltus_status_text((uint32_t)status));
    }
    return status != SALTUS_STATUS_OK;
}

/* The whole of a file; NULL where there is none. */
static uint8_t *read_file(const char *folder, const char *name, size_t *bytes) {
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "rb");
    if (!file || fseek(file, 0, SEEK_END) != 0) {
        printf("cannot open %s\n", path);
        return NULL;
    }
    long length = ftell(file);
    rewind(file);
    uint8_t *content = malloc((size_t)length);
    *bytes = content ? fread(content, 1, (size_t)length, file) : 0;
    fclose(file);
    return content;
}

/* Memory for a block: as large and as aligned as the library asks for. */
static void *block(size_t size, size_t align) {
    return aligned_alloc(align, (size + align - 1) / align * align);
}

/* The robot where the plan begins, at rest. */
static void place_robot(void) {
    mj_resetData(model, data);
    const double *q = about.start_orientation_wb;
    memcpy(data->qpos, about.start_position_w, sizeof about.start_position_w);
    data->qpos[3] = q[3]; /* MuJoCo has w first. */
    memcpy(data->qpos + 4, q, 3 * sizeof *q);
    memcpy(data->qpos + 7, about.start_joints, sizeof about.start_joints);
    mj_forward(model, data);
}

static int load(const char *folder) {
    plan = read_file(folder, "plan.bin", &plan_bytes);
    SaltusCulprit culprit;
    if (!plan || failed("plan", saltus_a1_plan_read(plan, plan_bytes, &about, &culprit))) {
        return 0;
    }
    char path[1024], error[1000];
    snprintf(path, sizeof path, "%s/scene.xml", folder);
    model = mj_loadXML(path, NULL, error, sizeof error);
    if (!model) {
        printf("%s: %s\n", path, error);
        return 0;
    }
    data = mj_makeData(model);
    for (int foot = 0; foot < FEET; ++foot) {
        char name[16];
        snprintf(name, sizeof name, "touch%d", foot);
        foot_geoms[foot] = mj_name2id(model, mjOBJ_GEOM, name);
    }
    place_robot();
    return 1;
}

/* The estimator as of a robot that rests where the plan begins, its joints as measured. */
static SaltusStatus begin_estimate(void) {
    SaltusA1Start start = {.imu_orientation_bi = {0, 0, 0, 1}};
    memcpy(start.position_w, about.start_position_w, sizeof start.position_w);
    memcpy(start.orientation_wb, about.start_orientation_wb, sizeof start.orientation_wb);
    memcpy(start.joints, data->qpos + 7, sizeof start.joints);
    return saltus_a1_estimator_init(estimator, saltus_a1_estimator_size(), SALTUS_VERSION, &start);
}

/* Normal forces of the ground on the feet, N. */
static void foot_forces(double forces[FEET]) {
    memset(forces, 0, FEET * sizeof *forces);
    for (int i = 0; i < data->ncon; ++i) {
        const mjContact *contact = &data->contact[i];
        mjtNum force[6];
        mj_contactForce(model, data, i, force);
        for (int foot = 0; foot < FEET; ++foot) {
            if (contact->geom[0] == foot_geoms[foot] || contact->geom[1] == foot_geoms[foot]) {
                forces[foot] += force[0];
            }
        }
    }
}

/* 0.1 ms under these torques; the sensors average over it. */
static void step(const double torques[JOINTS]) {
    double before_w[3], felt_w[3], felt_b[3], to_base[4];
    memcpy(before_w, data->qvel, sizeof before_w);
    memcpy(data->qfrc_applied + 6, torques, JOINTS * sizeof *torques);
    mj_step(model, data);
    for (int i = 0; i < 3; ++i) {
        felt_w[i] = (data->qvel[i] - before_w[i]) / model->opt.timestep - model->opt.gravity[i];
    }
    mju_negQuat(to_base, data->qpos + 3);
    mju_rotVecQuat(felt_b, felt_w, to_base);
    for (int i = 0; i < 3; ++i) {
        gathered.force_b[i] += felt_b[i];
        gathered.rate_b[i] += data->qvel[3 + i];
    }
    for (int i = 0; i < JOINTS; ++i) {
        double speed = data->qvel[6 + i], stick = speed / sqrt(speed * speed + 0.01);
        gathered.torques[i] += torques[i] - model->dof_damping[6 + i] * speed - model->dof_frictionloss[6 + i] * stick;
    }
    ++gathered.count;
}

/* What the sensors say of the last millisecond, with the base as the estimator has it. */
static int observe(SaltusA1Observation *seen) {
    SaltusA1Sample sample;
    double count = gathered.count > 0 ? gathered.count : 1;
    memset(seen, 0, sizeof *seen);
    for (int i = 0; i < 3; ++i) {
        sample.specific_force_i[i] = gathered.count > 0 ? gathered.force_b[i] / count : -model->opt.gravity[i];
        sample.angular_velocity_i[i] = gathered.rate_b[i] / count;
    }
    for (int i = 0; i < JOINTS; ++i) {
        seen->torques[i] = gathered.torques[i] / count;
    }
    memset(&gathered, 0, sizeof gathered);
    memcpy(seen->joints, data->qpos + 7, sizeof seen->joints);
    memcpy(seen->joint_velocities, data->qvel + 6, sizeof seen->joint_velocities);
    memcpy(sample.joints, seen->joints, sizeof sample.joints);
    memcpy(sample.joint_velocities, seen->joint_velocities, sizeof sample.joint_velocities);
    foot_forces(seen->foot_forces);
    for (int foot = 0; foot < FEET; ++foot) {
        sample.evidence[foot] = fmin(seen->foot_forces[foot] / LOADED, 1.0);
    }
    SaltusA1Estimate found;
    if (failed("estimator", saltus_a1_estimator_update(estimator, &sample, 1e-3, &found))) {
        return 0;
    }
    memcpy(seen->position_w, found.position_w, sizeof seen->position_w);
    memcpy(seen->orientation_wb, found.orientation_wb, sizeof seen->orientation_wb);
    memcpy(seen->linear_velocity_b, found.linear_velocity_b, sizeof seen->linear_velocity_b);
    memcpy(seen->angular_velocity_b, found.angular_velocity_b, sizeof seen->angular_velocity_b);
    seen->age = found.status == SALTUS_ESTIMATE_STATUS_LOST ? INFINITY : 0.0;
    return 1;
}

/* Middle of the feet in truth, m. */
static void middle_of_feet(double middle[3]) {
    memset(middle, 0, 3 * sizeof *middle);
    for (int foot = 0; foot < FEET; ++foot) {
        for (int i = 0; i < 3; ++i) {
            middle[i] += data->geom_xpos[3 * foot_geoms[foot] + i] / FEET;
        }
    }
}

/* Heading and tilt of the base in truth, rad. */
static void attitude(double *heading, double *tilt) {
    const double x[3] = {1, 0, 0}, z[3] = {0, 0, 1};
    double ahead[3], up[3];
    mju_rotVecQuat(ahead, x, data->qpos + 3);
    mju_rotVecQuat(up, z, data->qpos + 3);
    *heading = atan2(ahead[1], ahead[0]);
    *tilt = atan2(hypot(up[0], up[1]), up[2]);
}

/* Where the robot should be with its feet and its nose, and where it is: 1 if it stands there. `feet` is their middle at the start. */
static int judge(const double feet[3], double first_heading, SaltusPhase phase) {
    double turn = about.heading, heading, tilt, now[3], goal[2];
    double arm[2] = {feet[0] - about.start_position_w[0], feet[1] - about.start_position_w[1]};
    goal[0] = about.start_position_w[0] + about.goal_w[0] + cos(turn) * arm[0] - sin(turn) * arm[1];
    goal[1] = about.start_position_w[1] + about.goal_w[1] + sin(turn) * arm[0] + cos(turn) * arm[1];
    middle_of_feet(now);
    attitude(&heading, &tilt);
    double off = remainder(heading - first_heading - turn, 360 * DEGREE);
    double away = hypot(now[0] - goal[0], now[1] - goal[1]);
    int stands = phase == SALTUS_PHASE_LANDING || phase == SALTUS_PHASE_STAND;
    printf("  2 s after the touchdown: %s, tilt %.1f deg, feet %.3f m from the goal, heading off by %.1f deg\n",
           saltus_phase_text((uint32_t)phase), tilt / DEGREE, away, fabs(off) / DEGREE);
    return stands && tilt < 45 * DEGREE && away <= 0.10 && fabs(off) <= 10 * DEGREE;
}

/* How far the estimate is from the truth, m. */
static double estimate_error(const SaltusA1Observation *seen) {
    double square = 0;
    for (int i = 0; i < 3; ++i) {
        square += pow(seen->position_w[i] - data->qpos[i], 2);
    }
    return sqrt(square);
}

/* The jump; 1 if it ends where it should. */
static int fly(void) {
    double feet[3], heading, tilt, touchdown = -1, highest = 0, worst = 0, torques[JOINTS] = {0}, given[JOINTS];
    SaltusA1Observation seen;
    SaltusA1Tick tick = {.phase = SALTUS_PHASE_STAND};
    SaltusCulprit culprit;
    middle_of_feet(feet);
    attitude(&heading, &tilt);
    const long arms = lround(STANDS * 1e3), last = arms + lround((HOLDS + about.touchdown + SETTLES + 1) * 1e3);
    for (long k = 0; k < last; ++k) {
        const double now = 1e-3 * (double)k;
        if (k == arms) {
            SaltusStatus armed = saltus_a1_machine_arm(machine, plan, plan_bytes, now + HOLDS, &culprit);
            if (failed("arm", armed) || failed("estimator", begin_estimate())) {
                printf("  %s, node %d\n", culprit.what, (int)culprit.node);
                return 0;
            }
        }
        if (!observe(&seen)) {
            return 0;
        }
        SaltusPhase before = tick.phase;
        SaltusStatus status = saltus_a1_machine_tick(machine, now, &seen, &tick);
        if (tick.phase != before) {
            printf("  %.3f s: %s\n", now - STANDS - HOLDS, saltus_phase_text((uint32_t)tick.phase));
        }
        if (failed("tick", status) || tick.refusal != SALTUS_REFUSAL_NONE) {
            printf("  %s %u, %s %u\n", saltus_fault_text((uint32_t)tick.fault), (unsigned)tick.fault_index,
                   saltus_refusal_text((uint32_t)tick.refusal), (unsigned)tick.refusal_joint);
            return 0;
        }
        double loads[FEET];
        foot_forces(loads);
        int falls = k > arms && (tick.phase == SALTUS_PHASE_PRE_LANDING || tick.phase == SALTUS_PHASE_LANDING);
        for (int foot = 0; foot < FEET && falls && touchdown < 0; ++foot) {
            touchdown = loads[foot] > LOADED ? now : touchdown;
        }
        highest = fmax(highest, data->qpos[2]);
        worst = fmax(worst, k > arms ? estimate_error(&seen) : 0);
        if (touchdown >= 0 && now >= touchdown + SETTLES) {
            printf("  base at most %.3f m high, estimate at most %.3f m off\n", highest, worst);
            return judge(feet, heading, tick.phase);
        }
        for (int i = 0; i < RATIO; ++i) {
            /* What was computed from these encoders acts from the next 0.1 ms on. */
            memcpy(given, torques, sizeof given);
            double q[JOINTS], qd[JOINTS];
            memcpy(q, data->qpos + 7, sizeof q);
            memcpy(qd, data->qvel + 6, sizeof qd);
            if (failed("joint tick", saltus_a1_machine_joint_tick(machine, q, qd, 1e-4, torques))) {
                return 0;
            }
            step(given);
        }
    }
    puts("  the ground did not come");
    return 0;
}

int main(int count, char **words) {
    if (count != 2 || saltus_version() != SALTUS_VERSION) {
        puts("usage: fly_a1 FOLDER, with plan.bin and scene.xml");
        return 2;
    }
    machine = block(saltus_a1_machine_size(), saltus_a1_machine_align());
    estimator = block(saltus_a1_estimator_size(), saltus_a1_estimator_align());
    if (!machine || !estimator || !load(words[1])) {
        return 2;
    }
    if (failed("machine", saltus_a1_machine_init(machine, saltus_a1_machine_size(), SALTUS_VERSION)) || failed("estimator", begin_estimate())) {
        return 2;
    }
    printf("%s: %u nodes, goal %.2f %.2f %.2f m, %.0f deg\n", about.task, (unsigned)about.nodes, about.goal_w[0], about.goal_w[1], about.goal_w[2],
           about.heading / DEGREE);
    int stands = fly();
    puts(stands ? "  stands" : "  NO");
    mj_deleteData(data);
    mj_deleteModel(model);
    free(estimator);
    free(machine);
    free(plan);
    return stands ? 0 : 1;
}
