/* Saltus: dynamics and controllers of A1 and iCub for C.
 *
 * Generated from firmware/c-abi by `cargo xtask c-abi --overwrite`. Do not edit.
 *
 * All numbers are SI, in double precision. World z points up. Base velocities are in base axes, linear first.
 * A rotation takes base coordinates to world coordinates: a matrix by rows, or, where the name is orientation, a unit quaternion x, y, z, w.
 * Joint orders: A1 FL, FR, RL, RR with hip, thigh, calf; iCub left leg, right leg, torso, left arm, right arm.
 *
 * A controller lives in memory of the caller: ask for its size and alignment, give a block, initialise it, and call
 * it from one thread at a time. A block must not be copied or moved after it was initialised: that is noticed, and the
 * status says so. Every function checks its pointers; no function allocates, blocks, calls back or keeps a pointer, with one
 * exception: A1's machine follows its plan where it is, so the plan's bytes must stay there, unchanged, until the machine is armed with
 * another plan or initialised anew. What a call writes must not overlap what it reads.
 */

#ifndef SALTUS_H
#define SALTUS_H

#include <stddef.h>
#include <stdint.h>

/*
 Version of the interface; a controller is initialised with the version that the caller was compiled with.
 */
#define SALTUS_VERSION 5

/*
 What came of a call.
 */
typedef enum SaltusStatus {
  /*
   The call did what it says.
   */
  SALTUS_STATUS_OK = 0,
  /*
   A pointer is null.
   */
  SALTUS_STATUS_NULL_POINTER = 1,
  /*
   A pointer is not aligned for what it points to.
   */
  SALTUS_STATUS_MISALIGNED = 2,
  /*
   The block is too small: ask for its size.
   */
  SALTUS_STATUS_TOO_SMALL = 3,
  /*
   The caller was compiled with another version of the header.
   */
  SALTUS_STATUS_WRONG_VERSION = 4,
  /*
   The block was not initialised, or for another controller, or it was moved since.
   */
  SALTUS_STATUS_NOT_INITIALISED = 5,
  /*
   A number is not finite, or limits are inverted; outputs are the safe command.
   */
  SALTUS_STATUS_BAD_DATA = 6,
  /*
   The program was not solved; outputs are the best that was found, or the safe command.
   */
  SALTUS_STATUS_NOT_SOLVED = 7,
  /*
   The plan's bytes end before it does; the culprit has both lengths.
   */
  SALTUS_STATUS_PLAN_CUT_OFF = 8,
  /*
   The bytes are no plan.
   */
  SALTUS_STATUS_NOT_A_PLAN = 9,
  /*
   The plan is of another version of the format; the culprit has both.
   */
  SALTUS_STATUS_PLAN_VERSION = 10,
  /*
   The plan's checksum does not fit: bytes have changed.
   */
  SALTUS_STATUS_PLAN_DAMAGED = 11,
  /*
   The plan is for a robot with other numbers of joints and feet; the culprit has both.
   */
  SALTUS_STATUS_PLAN_SIZE = 12,
  /*
   The plan is for another robot of the same size; the culprit has both hashes.
   */
  SALTUS_STATUS_PLAN_ROBOT = 13,
  /*
   The plan's header contradicts its length.
   */
  SALTUS_STATUS_PLAN_HEADER = 14,
  /*
   A value of the plan cannot be, though the checksum fits; the culprit names it and its node.
   */
  SALTUS_STATUS_PLAN_VALUE = 15,
  /*
   The robot does not stand: it holds for another jump, is under way, or has aborted.
   */
  SALTUS_STATUS_NOT_STANDING = 16,
  /*
   The start is not a number, or leaves less time than holding still, weighing and moving the trunk take.
   */
  SALTUS_STATUS_TOO_LATE = 17,
  /*
   The machine has aborted, its fault says why; outputs damp the joints and nothing else.
   */
  SALTUS_STATUS_ABORTED = 18,
} SaltusStatus;

/*
 Whether an estimate may be acted on.
 */
typedef enum SaltusEstimateStatus {
  /*
   Fresh.
   */
  SALTUS_ESTIMATE_STATUS_GOOD = 0,
  /*
   Samples are missing, for a short time so far.
   */
  SALTUS_ESTIMATE_STATUS_COASTING = 1,
  /*
   They are missing for too long: the estimate stands still where it was.
   */
  SALTUS_ESTIMATE_STATUS_LOST = 2,
} SaltusEstimateStatus;

/*
 What was wrong with a sample.
 */
typedef enum SaltusSampleFault {
  /*
   Nothing.
   */
  SALTUS_SAMPLE_FAULT_NONE = 0,
  /*
   There was none.
   */
  SALTUS_SAMPLE_FAULT_MISSING = 1,
  /*
   The time step is not positive, not a number, or too long: nothing was done.
   */
  SALTUS_SAMPLE_FAULT_STEP = 2,
  /*
   The accelerometer is not finite or beyond its range: the last value was used.
   */
  SALTUS_SAMPLE_FAULT_ACCELEROMETER = 3,
  /*
   The gyroscope is not finite or beyond its range: the last value was used.
   */
  SALTUS_SAMPLE_FAULT_GYROSCOPE = 4,
  /*
   A joint is not finite: the feet that it moves were not used; the index says which.
   */
  SALTUS_SAMPLE_FAULT_JOINT = 5,
  /*
   The evidence of a foot is not a number: it was not used; the index says which.
   */
  SALTUS_SAMPLE_FAULT_EVIDENCE = 6,
  /*
   The numbers left the finite range: the last good state was restored.
   */
  SALTUS_SAMPLE_FAULT_DIVERGED = 7,
  /*
   Another fault of a newer estimator.
   */
  SALTUS_SAMPLE_FAULT_OTHER = 8,
} SaltusSampleFault;

/*
 Where a jump is.
 */
typedef enum SaltusPhase {
  /*
   Standing at the first node of the plan, before the start.
   */
  SALTUS_PHASE_HOLD = 0,
  /*
   Pushing off.
   */
  SALTUS_PHASE_STANCE = 1,
  /*
   In the air, on the way to the landing posture.
   */
  SALTUS_PHASE_FLIGHT = 2,
  /*
   In the air, waiting for the ground.
   */
  SALTUS_PHASE_PRE_LANDING = 3,
  /*
   On the ground again, taking up the impact.
   */
  SALTUS_PHASE_LANDING = 4,
  /*
   At rest: a plan may be armed.
   */
  SALTUS_PHASE_STAND = 5,
  /*
   Joints are damped and nothing else, until the machine is initialised anew.
   */
  SALTUS_PHASE_ABORT = 6,
} SaltusPhase;

/*
 What a tick of the machine computed.
 */
typedef enum SaltusWork {
  /*
   Joints damped, nothing else.
   */
  SALTUS_WORK_DAMPING = 0,
  /*
   A1's feet pulled along the plan.
   */
  SALTUS_WORK_CARTESIAN = 1,
  /*
   iCub's torques of holding still and pushing off, optimal.
   */
  SALTUS_WORK_PUSH_OFF = 2,
  /*
   The same, not optimal: the last iterate, inside every limit.
   */
  SALTUS_WORK_PUSH_OFF_CAPPED = 3,
  /*
   A1's landing, with no foot in contact: nothing to solve.
   */
  SALTUS_WORK_AIRBORNE = 4,
  /*
   A1's forces of landing and standing, iCub's torques of flight, landing and standing, optimal.
   */
  SALTUS_WORK_LANDING = 5,
  /*
   The same, not optimal: the last iterate, inside every limit.
   */
  SALTUS_WORK_LANDING_CAPPED = 6,
  /*
   A program of iCub's had no answer: the last command stays.
   */
  SALTUS_WORK_UNSOLVED = 7,
} SaltusWork;

/*
 Which rows of a program had to yield, so that the others hold. None of A1's can.
 */
typedef enum SaltusYielded {
  /*
   None.
   */
  SALTUS_YIELDED_NOTHING = 0,
  /*
   Held tasks.
   */
  SALTUS_YIELDED_TASKS = 1,
  /*
   Limits on the joints' motion, too.
   */
  SALTUS_YIELDED_MOTION_LIMITS = 2,
  /*
   Contacts, too.
   */
  SALTUS_YIELDED_CONTACTS = 3,
} SaltusYielded;

/*
 Why a machine has aborted.
 */
typedef enum SaltusFault {
  /*
   It has not.
   */
  SALTUS_FAULT_NONE = 0,
  /*
   Position or velocity of a joint is not finite; the index says which.
   */
  SALTUS_FAULT_JOINT = 1,
  /*
   Pose or velocity of the base is not finite, or its quaternion is not of length 1.
   */
  SALTUS_FAULT_BASE = 2,
  /*
   Force of a foot is not finite; the index says which.
   */
  SALTUS_FAULT_FOOT = 3,
  /*
   The observation is older than 10 ms, or its age is no age.
   */
  SALTUS_FAULT_STALE = 4,
  /*
   The clock stood still, went backwards, or is not a number.
   */
  SALTUS_FAULT_CLOCK = 5,
  /*
   One of the two loops did not run for 5 ms.
   */
  SALTUS_FAULT_SILENT = 6,
  /*
   A controller's command was not finite.
   */
  SALTUS_FAULT_COMMAND = 7,
  /*
   A controller's program had no answer for 5 ms.
   */
  SALTUS_FAULT_UNSOLVED = 8,
  /*
   Another fault of a newer machine.
   */
  SALTUS_FAULT_OTHER = 9,
} SaltusFault;

/*
 Why the last jump was not begun; the robot goes on standing.
 */
typedef enum SaltusRefusal {
  /*
   It was begun, or there was none.
   */
  SALTUS_REFUSAL_NONE = 0,
  /*
   The robot does not stand.
   */
  SALTUS_REFUSAL_NOT_STANDING = 1,
  /*
   The start is not a number, or too near.
   */
  SALTUS_REFUSAL_TOO_LATE = 2,
  /*
   At the start a joint was not where the plan begins; the index says which.
   */
  SALTUS_REFUSAL_POSTURE = 3,
  /*
   The feet were not where the jump begins.
   */
  SALTUS_REFUSAL_PLACE = 4,
  /*
   Another reason of a newer machine.
   */
  SALTUS_REFUSAL_OTHER = 5,
  /*
   The base is tilted further than that of a robot on its feet.
   */
  SALTUS_REFUSAL_TILTED = 6,
} SaltusRefusal;

/*
 State of a robot: base and joints.
 */
typedef struct SaltusA1State {
  /*
   Position of the base in the world, m.
   */
  double position_w[3];
  /*
   Rotation of the base, base to world, by rows.
   */
  double rotation_wb[9];
  /*
   Linear velocity of the base in base axes, m/s.
   */
  double linear_velocity_b[3];
  /*
   Angular velocity of the base in base axes, rad/s.
   */
  double angular_velocity_b[3];
  /*
   Joint positions, rad.
   */
  double joints[12];
  /*
   Joint velocities, rad/s.
   */
  double joint_velocities[12];
} SaltusA1State;

/*
 What the joints are to do until the next command: τ = `feed_forward` + `stiffness` (`position` − q) + `damping`
 (`velocity` − q̇), inside what the motors can do.
 */
typedef struct SaltusA1Command {
  /*
   Joint positions, rad.
   */
  double position[12];
  /*
   Joint velocities, rad/s.
   */
  double velocity[12];
  /*
   Torques, N m.
   */
  double feed_forward[12];
  /*
   Stiffnesses, N m/rad.
   */
  double stiffness[12];
  /*
   Dampings, N m s/rad.
   */
  double damping[12];
} SaltusA1Command;

/*
 What a plan says about one instant.
 */
typedef struct SaltusA1Reference {
  /*
   Joint positions, rad.
   */
  double joints[12];
  /*
   Joint velocities, rad/s.
   */
  double joint_velocities[12];
  /*
   Torques, N m.
   */
  double torques[12];
} SaltusA1Reference;

/*
 Where the landing is to bring the body.
 */
typedef struct SaltusA1Target {
  /*
   Height of the centre of mass over the feet in contact, m.
   */
  double height;
  /*
   Rotation of the base at rest, base to world, by rows.
   */
  double rotation_wb[9];
  /*
   Offset of the centre of mass from the middle of the feet, world axes, m.
   */
  double offset_w[2];
  /*
   Posture of legs that are in the air, rad.
   */
  double waiting[12];
} SaltusA1Target;

/*
 Where the robot stands still when the estimator begins, and where its IMU is.
 */
typedef struct SaltusA1Start {
  /*
   Position of the base in the world, m.
   */
  double position_w[3];
  /*
   Orientation of the base: a unit quaternion x, y, z, w.
   */
  double orientation_wb[4];
  /*
   Joint positions, rad.
   */
  double joints[12];
  /*
   Position of the IMU in the base, m.
   */
  double imu_position_b[3];
  /*
   Orientation of the IMU in the base: a unit quaternion x, y, z, w that takes IMU axes to base axes.
   */
  double imu_orientation_bi[4];
} SaltusA1Start;

/*
 What the sensors say every millisecond.
 */
typedef struct SaltusA1Sample {
  /*
   Accelerometer: acceleration minus gravity, IMU axes, m/s²; at rest it points up.
   */
  double specific_force_i[3];
  /*
   Gyroscope, IMU axes, rad/s.
   */
  double angular_velocity_i[3];
  /*
   Joint positions, rad.
   */
  double joints[12];
  /*
   Joint velocities, rad/s.
   */
  double joint_velocities[12];
  /*
   How certainly each foot stands, 0 to 1: its force over 15 N of A1, over 40 N of iCub, for one.
   */
  double evidence[4];
} SaltusA1Sample;

/*
 Where the base is; always finite. The first four go into an observation of the machine as they are.
 */
typedef struct SaltusA1Estimate {
  /*
   Position of the base in the world, m.
   */
  double position_w[3];
  /*
   Orientation of the base: a unit quaternion x, y, z, w.
   */
  double orientation_wb[4];
  /*
   Linear velocity of the base in base axes, m/s.
   */
  double linear_velocity_b[3];
  /*
   Angular velocity of the base in base axes, rad/s.
   */
  double angular_velocity_b[3];
  /*
   How sure it is that each foot stands on the ground, 0 to 1.
   */
  double confidence[4];
  /*
   Whether it may be acted on; what is lost makes an observation of infinite age.
   */
  enum SaltusEstimateStatus status;
  /*
   The first thing that was wrong with the sample.
   */
  enum SaltusSampleFault fault;
  /*
   Its joint or foot.
   */
  uint32_t fault_index;
} SaltusA1Estimate;

/*
 What a plan says about itself.
 */
typedef struct SaltusA1Plan {
  /*
   When the robot leaves the ground, s after the start.
   */
  double takeoff;
  /*
   When it takes up its landing posture, s.
   */
  double posing;
  /*
   When the plan expects the ground, s.
   */
  double touchdown;
  /*
   Weight that it was planned for, N.
   */
  double weight;
  /*
   Where the base is to be in the end, seen from where it started, world axes, m.
   */
  double goal_w[3];
  /*
   Where it is to look then: the angle about the world's z, rad.
   */
  double heading;
  /*
   Position of the base at the start, m.
   */
  double start_position_w[3];
  /*
   Its orientation: a unit quaternion x, y, z, w.
   */
  double start_orientation_wb[4];
  /*
   Joint positions at the start, rad.
   */
  double start_joints[12];
  /*
   Joint positions in which the robot waits for the ground, rad.
   */
  double landing_joints[12];
  /*
   By how much the ground is lower beyond the edge of a box, m; negative where the robot jumps up; 0 without a box.
   */
  double drop;
  /*
   Distance of that edge from the origin towards the landing, m.
   */
  double edge;
  /*
   The world's axis across the edge: 0 is x, 1 is y.
   */
  uint32_t edge_axis;
  /*
   On which side of the edge it lands, ±1; 0 without a box.
   */
  int32_t edge_side;
  /*
   Number of nodes.
   */
  uint32_t nodes;
  /*
   Name of the task, ended by a zero.
   */
  char task[256];
} SaltusA1Plan;

/*
 What it is that makes a plan none: filled by calls that read one.
 */
typedef struct SaltusCulprit {
  /*
   Name of the value, ended by a zero; empty where the status says it all.
   */
  char what[48];
  /*
   The node that it stands in, −1 for the header.
   */
  int32_t node;
  /*
   What was found: a length in bytes, a version, numbers of joints and feet (256 × joints + feet), or the hash of a robot.
   */
  uint64_t found;
  /*
   What was expected.
   */
  uint64_t expected;
} SaltusCulprit;

/*
 What the machine is told every millisecond; the base as an estimator has it, such as this header's.
 */
typedef struct SaltusA1Observation {
  /*
   Position of the base in the world, m.
   */
  double position_w[3];
  /*
   Orientation of the base: a unit quaternion x, y, z, w.
   */
  double orientation_wb[4];
  /*
   Linear velocity of the base in base axes, m/s.
   */
  double linear_velocity_b[3];
  /*
   Angular velocity of the base in base axes, rad/s.
   */
  double angular_velocity_b[3];
  /*
   Joint positions, rad.
   */
  double joints[12];
  /*
   Joint velocities, rad/s.
   */
  double joint_velocities[12];
  /*
   Mean torques of the joints since the last observation, friction included, N m. iCub's machine does not read them.
   */
  double torques[12];
  /*
   Normal forces on the feet, N.
   */
  double foot_forces[4];
  /*
   Age of the oldest of these numbers, s; infinite where the base is not known.
   */
  double age;
} SaltusA1Observation;

/*
 What came of a tick.
 */
typedef struct SaltusA1Tick {
  /*
   Where the jump is.
   */
  enum SaltusPhase phase;
  /*
   What was computed.
   */
  enum SaltusWork work;
  /*
   Iterations of a program's solver, 0 where nothing was solved.
   */
  uint32_t iterations;
  /*
   Which rows of a program had to yield.
   */
  enum SaltusYielded yielded;
  /*
   Why the machine has aborted: the first fault.
   */
  enum SaltusFault fault;
  /*
   The fault's joint or foot.
   */
  uint32_t fault_index;
  /*
   Why the last jump was not begun.
   */
  enum SaltusRefusal refusal;
  /*
   The refusal's joint.
   */
  uint32_t refusal_joint;
  /*
   What the joints are to do until the next tick: for motor boards that take such commands. Who calls the machine's joint tick
   need not look at it.
   */
  struct SaltusA1Command command;
} SaltusA1Tick;

/*
 State of a robot: base and joints.
 */
typedef struct SaltusIcubState {
  /*
   Position of the base in the world, m.
   */
  double position_w[3];
  /*
   Rotation of the base, base to world, by rows.
   */
  double rotation_wb[9];
  /*
   Linear velocity of the base in base axes, m/s.
   */
  double linear_velocity_b[3];
  /*
   Angular velocity of the base in base axes, rad/s.
   */
  double angular_velocity_b[3];
  /*
   Joint positions, rad.
   */
  double joints[23];
  /*
   Joint velocities, rad/s.
   */
  double joint_velocities[23];
} SaltusIcubState;

/*
 Where the robot stands still when the estimator begins, and where its IMU is.
 */
typedef struct SaltusIcubStart {
  /*
   Position of the base in the world, m.
   */
  double position_w[3];
  /*
   Orientation of the base: a unit quaternion x, y, z, w.
   */
  double orientation_wb[4];
  /*
   Joint positions, rad.
   */
  double joints[23];
  /*
   Position of the IMU in the base, m.
   */
  double imu_position_b[3];
  /*
   Orientation of the IMU in the base: a unit quaternion x, y, z, w that takes IMU axes to base axes.
   */
  double imu_orientation_bi[4];
} SaltusIcubStart;

/*
 What the sensors say every millisecond.
 */
typedef struct SaltusIcubSample {
  /*
   Accelerometer: acceleration minus gravity, IMU axes, m/s²; at rest it points up.
   */
  double specific_force_i[3];
  /*
   Gyroscope, IMU axes, rad/s.
   */
  double angular_velocity_i[3];
  /*
   Joint positions, rad.
   */
  double joints[23];
  /*
   Joint velocities, rad/s.
   */
  double joint_velocities[23];
  /*
   How certainly each foot stands, 0 to 1: its force over 15 N of A1, over 40 N of iCub, for one.
   */
  double evidence[2];
} SaltusIcubSample;

/*
 Where the base is; always finite. The first four go into an observation of the machine as they are.
 */
typedef struct SaltusIcubEstimate {
  /*
   Position of the base in the world, m.
   */
  double position_w[3];
  /*
   Orientation of the base: a unit quaternion x, y, z, w.
   */
  double orientation_wb[4];
  /*
   Linear velocity of the base in base axes, m/s.
   */
  double linear_velocity_b[3];
  /*
   Angular velocity of the base in base axes, rad/s.
   */
  double angular_velocity_b[3];
  /*
   How sure it is that each foot stands on the ground, 0 to 1.
   */
  double confidence[2];
  /*
   Whether it may be acted on; what is lost makes an observation of infinite age.
   */
  enum SaltusEstimateStatus status;
  /*
   The first thing that was wrong with the sample.
   */
  enum SaltusSampleFault fault;
  /*
   Its joint or foot.
   */
  uint32_t fault_index;
} SaltusIcubEstimate;

/*
 A jump of iCub on the spot: how far it rises, from where, and how it comes down.
 */
typedef struct SaltusIcubJump {
  /*
   Height that the centre of mass gains after the take-off, m.
   */
  double height;
  /*
   Its way up in the push-off, m.
   */
  double displacement;
  /*
   Position of the base before the jump, in the estimator's world, m: both soles flat on the ground.
   */
  double position_w[3];
  /*
   Orientation of the base there: a unit quaternion x, y, z, w.
   */
  double orientation_wb[4];
  /*
   Joint positions there, rad.
   */
  double start_joints[23];
  /*
   Joint positions in which the soles meet the ground and the robot then stands, rad.
   */
  double landing_joints[23];
} SaltusIcubJump;

/*
 What the machine is told every millisecond; the base as an estimator has it, such as this header's.
 */
typedef struct SaltusIcubObservation {
  /*
   Position of the base in the world, m.
   */
  double position_w[3];
  /*
   Orientation of the base: a unit quaternion x, y, z, w.
   */
  double orientation_wb[4];
  /*
   Linear velocity of the base in base axes, m/s.
   */
  double linear_velocity_b[3];
  /*
   Angular velocity of the base in base axes, rad/s.
   */
  double angular_velocity_b[3];
  /*
   Joint positions, rad.
   */
  double joints[23];
  /*
   Joint velocities, rad/s.
   */
  double joint_velocities[23];
  /*
   Mean torques of the joints since the last observation, friction included, N m. iCub's machine does not read them.
   */
  double torques[23];
  /*
   Normal forces on the feet, N.
   */
  double foot_forces[2];
  /*
   Age of the oldest of these numbers, s; infinite where the base is not known.
   */
  double age;
} SaltusIcubObservation;

/*
 What the joints are to do until the next command: τ = `feed_forward` + `stiffness` (`position` − q) + `damping`
 (`velocity` − q̇), inside what the motors can do.
 */
typedef struct SaltusIcubCommand {
  /*
   Joint positions, rad.
   */
  double position[23];
  /*
   Joint velocities, rad/s.
   */
  double velocity[23];
  /*
   Torques, N m.
   */
  double feed_forward[23];
  /*
   Stiffnesses, N m/rad.
   */
  double stiffness[23];
  /*
   Dampings, N m s/rad.
   */
  double damping[23];
} SaltusIcubCommand;

/*
 What came of a tick.
 */
typedef struct SaltusIcubTick {
  /*
   Where the jump is.
   */
  enum SaltusPhase phase;
  /*
   What was computed.
   */
  enum SaltusWork work;
  /*
   Iterations of a program's solver, 0 where nothing was solved.
   */
  uint32_t iterations;
  /*
   Which rows of a program had to yield.
   */
  enum SaltusYielded yielded;
  /*
   Why the machine has aborted: the first fault.
   */
  enum SaltusFault fault;
  /*
   The fault's joint or foot.
   */
  uint32_t fault_index;
  /*
   Why the last jump was not begun.
   */
  enum SaltusRefusal refusal;
  /*
   The refusal's joint.
   */
  uint32_t refusal_joint;
  /*
   What the joints are to do until the next tick: for motor boards that take such commands. Who calls the machine's joint tick
   need not look at it.
   */
  struct SaltusIcubCommand command;
} SaltusIcubTick;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/*
 The version of the library: [`VERSION`].
 */
uint32_t saltus_version(void);

/*
 Inverse dynamics of A1 with rotors: effort = M a + h. `acceleration` and `effort` have 18 numbers: 6 of the base, then joints.
 */
enum SaltusStatus saltus_a1_inverse_dynamics(const struct SaltusA1State *state,
                                             const double *acceleration,
                                             double *effort);

/*
 Forward dynamics of A1 with rotors, free in the air: acceleration = M⁻¹ (effort − h); 18 numbers each.
 */
enum SaltusStatus saltus_a1_forward_dynamics(const struct SaltusA1State *state,
                                             const double *given,
                                             double *acceleration);

/*
 Mass matrix of A1 with rotors, 18 × 18 numbers, symmetric.
 */
enum SaltusStatus saltus_a1_mass_matrix(const struct SaltusA1State *state, double *mass);

/*
 Torques of the twelve joints, for 10 kHz: the command inside what the motors can do. Joints whose numbers are not finite get
 zero torque.
 */
enum SaltusStatus saltus_a1_joint_pd(const struct SaltusA1Command *command,
                                     const double *joints,
                                     const double *joint_velocities,
                                     double *torques);

/*
 The Cartesian PD of push-off and flight, for 1 kHz: feet along a reference.
 */
enum SaltusStatus saltus_a1_cartesian_pd(const struct SaltusA1State *state,
                                         const struct SaltusA1Reference *reference,
                                         struct SaltusA1Command *command);

/*
 Bytes of the block of the landing controller.
 */
size_t saltus_a1_landing_size(void);

/*
 Alignment of the block of the landing controller.
 */
size_t saltus_a1_landing_align(void);

/*
 Initialises the landing controller in a block; `version` is `SALTUS_VERSION`.
 */
enum SaltusStatus saltus_a1_landing_init(void *memory, size_t bytes, uint32_t version);

/*
 One tick of the landing, for 1 kHz: forces of the feet in contact (`contacts`, four of them, zero or not) that bring the body to rest.
 Whatever the status, `command` may be given to the joints if it is neither `NullPointer` nor `Misaligned`.
 */
enum SaltusStatus saltus_a1_landing_step(void *memory,
                                         const struct SaltusA1State *state,
                                         const uint8_t *contacts,
                                         const struct SaltusA1Target *target,
                                         struct SaltusA1Command *command);

/*
 Bytes of the block of an estimator.
 */
size_t saltus_a1_estimator_size(void);

/*
 Alignment of the block of an estimator.
 */
size_t saltus_a1_estimator_align(void);

/*
 Initialises an estimator in a block, of a robot that stands still in a known place; `version` is `SALTUS_VERSION`. Before a jump it may be
 initialised anew where the plan begins, so that what it has drifted is forgotten.
 */
enum SaltusStatus saltus_a1_estimator_init(void *memory,
                                           size_t bytes,
                                           uint32_t version,
                                           const struct SaltusA1Start *start);

/*
 One step of `dt` s, for 1 kHz; `sample` is null if none arrived. What is wrong with a sample, the estimate says.
 */
enum SaltusStatus saltus_a1_estimator_update(void *memory,
                                             const struct SaltusA1Sample *sample,
                                             double dt,
                                             struct SaltusA1Estimate *estimate);

/*
 Looks at every number of a plan, and says what it is. `culprit` may be null.
 */
enum SaltusStatus saltus_a1_plan_read(const uint8_t *plan,
                                      size_t bytes,
                                      struct SaltusA1Plan *about,
                                      struct SaltusCulprit *culprit);

/*
 Bytes of the block of a machine.
 */
size_t saltus_a1_machine_size(void);

/*
 Alignment of the block of a machine.
 */
size_t saltus_a1_machine_align(void);

/*
 Initialises a machine in a block; `version` is `SALTUS_VERSION`. It stands, without a jump; until the first tick its joints are damped.
 The way out of an abort, too.
 */
enum SaltusStatus saltus_a1_machine_init(void *memory,
                                         size_t bytes,
                                         uint32_t version);

/*
 Gives a standing robot a plan that begins at `start`, s, on the clock of `saltus_a1_machine_tick`; until then it holds the plan's first
 node. The start must be at least 1.1 s after the last tick, and more ticks than half of the plan's nodes: in these the gains of the push-off are
 computed. Where that shows only at the start, since ticks were missed or none had told the time, the robot goes on standing and the tick's refusal is `TooLate`. The plan is what `saltus plan` writes as `plan.bin`; version,
 checksum, robot and every number of it are looked at, which takes as long as thirty ticks for 624 nodes. It is followed where it is: its bytes must
 stay there, unchanged, until the machine has another plan or is initialised anew. If the status is not `Ok`, nothing changes; a culprit
 that is not null then says what is to blame.
 */
enum SaltusStatus saltus_a1_machine_arm(void *memory,
                                        const uint8_t *plan,
                                        size_t bytes,
                                        double start,
                                        struct SaltusCulprit *culprit);

/*
 One tick of 1 kHz at the time `now`, s, on a clock that only goes forward. `observation` is what has arrived since the last tick, null if
 nothing: the last one is used until it is older than 10 ms. Whatever the status, `tick` holds a command that may be given to the joints
 if it is neither null nor misaligned. `Aborted` says that joints are damped from now on, and the tick's fault why.
 */
enum SaltusStatus saltus_a1_machine_tick(void *memory,
                                         double now,
                                         const struct SaltusA1Observation *observation,
                                         struct SaltusA1Tick *tick);

/*
 Torques of the twelve joints, N m, for 10 kHz, `dt` s after the last call, from their positions and velocities: inside what the motors can
 do, and no faster than their drives. Damping alone once ticks have been missing for 5 ms, or an encoder is not finite; and where the block is no machine.
 */
enum SaltusStatus saltus_a1_machine_joint_tick(void *memory,
                                               const double *joints,
                                               const double *joint_velocities,
                                               double dt,
                                               double *torques);

/*
 Where the jump is.
 */
enum SaltusStatus saltus_a1_machine_phase(void *memory, enum SaltusPhase *phase);

/*
 What a `SaltusStatus` means: a text ended by a zero, for any number.
 */
const char *saltus_status_text(uint32_t status);

/*
 The name of a `SaltusPhase`: a text ended by a zero, for any number.
 */
const char *saltus_phase_text(uint32_t phase);

/*
 What a `SaltusFault` means: a text ended by a zero, for any number.
 */
const char *saltus_fault_text(uint32_t fault);

/*
 What a `SaltusRefusal` means: a text ended by a zero, for any number.
 */
const char *saltus_refusal_text(uint32_t refusal);

/*
 What a `SaltusSampleFault` means: a text ended by a zero, for any number.
 */
const char *saltus_sample_fault_text(uint32_t fault);

/*
 Inverse dynamics of iCub with rotors: effort = M a + h. `acceleration` and `effort` have 29 numbers: 6 of the base, then joints.
 */
enum SaltusStatus saltus_icub_inverse_dynamics(const struct SaltusIcubState *state,
                                               const double *acceleration,
                                               double *effort);

/*
 Forward dynamics of iCub with rotors, free in the air: acceleration = M⁻¹ (effort − h); 29 numbers each.
 */
enum SaltusStatus saltus_icub_forward_dynamics(const struct SaltusIcubState *state,
                                               const double *given,
                                               double *acceleration);

/*
 Mass matrix of iCub with rotors, 29 × 29 numbers, symmetric.
 */
enum SaltusStatus saltus_icub_mass_matrix(const struct SaltusIcubState *state, double *mass);

/*
 Bytes of the block of an estimator.
 */
size_t saltus_icub_estimator_size(void);

/*
 Alignment of the block of an estimator.
 */
size_t saltus_icub_estimator_align(void);

/*
 Initialises an estimator in a block, of a robot that stands still in a known place; `version` is `SALTUS_VERSION`. Before a jump it may be
 initialised anew where the jump begins, so that what it has drifted is forgotten.
 */
enum SaltusStatus saltus_icub_estimator_init(void *memory,
                                             size_t bytes,
                                             uint32_t version,
                                             const struct SaltusIcubStart *start);

/*
 One step of `dt` s, for 1 kHz; `sample` is null if none arrived. What is wrong with a sample, the estimate says.
 */
enum SaltusStatus saltus_icub_estimator_update(void *memory,
                                               const struct SaltusIcubSample *sample,
                                               double dt,
                                               struct SaltusIcubEstimate *estimate);

/*
 The jump of paper B: from its squat, the soles on ground of height 0, the toes along x and the soles' middle in the origin, to a gain of
 `height`, m; the paper's is 0.04.
 */
enum SaltusStatus saltus_icub_jump(double height,
                                   struct SaltusIcubJump *jump);

/*
 Bytes of the block of a machine.
 */
size_t saltus_icub_machine_size(void);

/*
 Alignment of the block of a machine.
 */
size_t saltus_icub_machine_align(void);

/*
 Initialises a machine in a block; `version` is `SALTUS_VERSION`. It stands, without a jump; until the first tick its joints are damped.
 The way out of an abort, too. `max_steps` is the most steps of a program's solver in a tick, 0 for no cap: with 10 a tick takes a million instructions on
 a Cortex-M7 at most, and with every other 15,000 more. The programs' memory is made on the stack before it is moved into the block: this call
 takes 370 kB of it.
 */
enum SaltusStatus saltus_icub_machine_init(void *memory,
                                           size_t bytes,
                                           uint32_t version,
                                           uint32_t max_steps);

/*
 Gives a standing robot a jump that begins at `start`, s, on the clock of `saltus_icub_machine_tick`; until then it holds the jump's first
 posture. The start must not be before the last tick. The numbers are copied. `BadData` says that one of them is not finite, that height and displacement
 are not positive, or that the orientation is none. If the status is not `Ok`, nothing changes.
 */
enum SaltusStatus saltus_icub_machine_arm(void *memory,
                                          const struct SaltusIcubJump *jump,
                                          double start);

/*
 One tick of 1 kHz at the time `now`, s, on a clock that only goes forward. `observation` is what has arrived since the last tick, null if
 nothing: the last one is used until it is older than 10 ms. Whatever the status, `tick` holds a command that may be given to the joints
 if it is neither null nor misaligned. `Aborted` says that joints are damped from now on, and the tick's fault why.
 */
enum SaltusStatus saltus_icub_machine_tick(void *memory,
                                           double now,
                                           const struct SaltusIcubObservation *observation,
                                           struct SaltusIcubTick *tick);

/*
 Torques of the 23 joints, N m, for 10 kHz, `dt` s after the last call, from their positions and velocities: inside what the motors can
 do. Damping alone once ticks have been missing for 5 ms, or an encoder is not finite; and where the block is no machine.
 */
enum SaltusStatus saltus_icub_machine_joint_tick(void *memory,
                                                 const double *joints,
                                                 const double *joint_velocities,
                                                 double dt,
                                                 double *torques);

/*
 Where the jump is.
 */
enum SaltusStatus saltus_icub_machine_phase(void *memory, enum SaltusPhase *phase);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* SALTUS_H */
