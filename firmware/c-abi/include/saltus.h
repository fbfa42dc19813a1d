/* Saltus: dynamics and controllers of A1 and iCub for C.
 *
 * Generated from firmware/c-abi by `cargo xtask c-abi --overwrite`. Do not edit.
 *
 * All numbers are SI, in double precision. World z points up. Base velocities are in base axes, linear first.
 * Rotations are row-major matrices that take base coordinates to world coordinates.
 * Joint orders: A1 FL, FR, RL, RR with hip, thigh, calf; iCub left leg, right leg, torso, left arm, right arm.
 *
 * A controller lives in memory of the caller: ask for its size and alignment, give a block, initialise it, and call
 * it from one thread at a time. A block must not be copied or moved after it was initialised: that is noticed, and the
 * status says so. Every function checks its pointers; no function allocates, blocks, calls back or keeps a pointer.
 */

#ifndef SALTUS_H
#define SALTUS_H

#include <stddef.h>
#include <stdint.h>

/*
 Version of the interface; a controller is initialised with the version that the caller was compiled with.
 */
#define SALTUS_VERSION 2

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
} SaltusStatus;

/*
 State of A1: base and twelve joints.
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
 State of iCub: base and 23 joints.
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
 Where the centre of mass is to be in this tick, world axes.
 */
typedef struct SaltusIcubTarget {
  /*
   Position, m.
   */
  double position_w[3];
  /*
   Velocity, m/s.
   */
  double velocity_w[3];
  /*
   Acceleration, m/s².
   */
  double acceleration_w[3];
} SaltusIcubTarget;

/*
 What the push-off's program found.
 */
typedef struct SaltusIcubCommand {
  /*
   Joint torques, N m, inside their limits.
   */
  double torques[23];
  /*
   Wrenches on left and right sole in the soles' axes: force in N, then moment in N m.
   */
  double wrenches[12];
  /*
   Which rows had to yield: 0 none, 1 held tasks, 2 also limits on the joints' motion, 3 also contacts.
   */
  uint32_t yielded;
  /*
   Iterations of the solver.
   */
  uint32_t iterations;
  /*
   1 if the cap on the solver's time ended the search: torques are the last iterate's, cut to their limits, and the next tick goes
   on from there. Otherwise 0.
   */
  uint32_t capped;
} SaltusIcubCommand;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/*
 The version of the library: [`VERSION`].
 */
uint32_t saltus_version(void);

/*
 Inverse dynamics of A1 with rotors: effort = M a + h. `acceleration` and `effort` have 6 numbers of the base, then joints.
 */
enum SaltusStatus saltus_a1_inverse_dynamics(const struct SaltusA1State *state,
                                             const double (*acceleration)[18],
                                             double (*effort)[18]);

/*
 Forward dynamics of A1 with rotors, free in the air: acceleration = M⁻¹ (effort − h).
 */
enum SaltusStatus saltus_a1_forward_dynamics(const struct SaltusA1State *state,
                                             const double (*given)[18],
                                             double (*acceleration)[18]);

/*
 Mass matrix of A1 with rotors, 18 × 18, symmetric.
 */
enum SaltusStatus saltus_a1_mass_matrix(const struct SaltusA1State *state, double (*mass)[18][18]);

/*
 Torques of the joints, for 10 kHz: the command inside what the motors can do. Joints whose numbers are not finite get
 zero torque.
 */
enum SaltusStatus saltus_a1_joint_pd(const struct SaltusA1Command *command,
                                     const double (*joints)[12],
                                     const double (*joint_velocities)[12],
                                     double (*torques)[12]);

/*
 The Cartesian PD of push-off and flight, for 1 kHz: feet along a reference. `then` is the reference for the time when
 the state was measured.
 */
enum SaltusStatus saltus_a1_cartesian_pd(const struct SaltusA1State *state,
                                         const struct SaltusA1Reference *reference,
                                         const struct SaltusA1Reference *then,
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
 One tick of the landing, for 1 kHz: forces of the feet in contact (`contacts`, zero or not) that bring the body to rest.
 Whatever the status, `command` may be given to the joints if it is neither `NullPointer` nor `Misaligned`.
 */
enum SaltusStatus saltus_a1_landing_step(void *memory,
                                         const struct SaltusA1State *state,
                                         const uint8_t (*contacts)[4],
                                         const struct SaltusA1Target *target,
                                         struct SaltusA1Command *command);

/*
 Inverse dynamics of iCub: effort = M a + h. `acceleration` and `effort` have 6 numbers of the base, then joints.
 */
enum SaltusStatus saltus_icub_inverse_dynamics(const struct SaltusIcubState *state,
                                               const double (*acceleration)[29],
                                               double (*effort)[29]);

/*
 Forward dynamics of iCub, free in the air: acceleration = M⁻¹ (effort − h).
 */
enum SaltusStatus saltus_icub_forward_dynamics(const struct SaltusIcubState *state,
                                               const double (*given)[29],
                                               double (*acceleration)[29]);

/*
 Mass matrix of iCub, 29 × 29, symmetric.
 */
enum SaltusStatus saltus_icub_mass_matrix(const struct SaltusIcubState *state,
                                          double (*mass)[29][29]);

/*
 Bytes of the block of the push-off controller.
 */
size_t saltus_icub_push_size(void);

/*
 Alignment of the block of the push-off controller.
 */
size_t saltus_icub_push_align(void);

/*
 Initialises the push-off controller in a block; `version` is `SALTUS_VERSION`, `posture` the joints to stay near, rad, and `max_steps` the
 most steps of the solver in a tick, 0 for no cap: with 12 a tick takes 720,000 instructions on a Cortex-M7, with every other 15,000 more.
 */
enum SaltusStatus saltus_icub_push_init(void *memory,
                                        size_t bytes,
                                        uint32_t version,
                                        const double (*posture)[23],
                                        uint32_t max_steps);

/*
 One tick of the push-off on both soles, for 1 kHz. If the status is not `Ok`, torques are zero.
 */
enum SaltusStatus saltus_icub_push_tick(void *memory,
                                        const struct SaltusIcubState *state,
                                        const struct SaltusIcubTarget *target,
                                        struct SaltusIcubCommand *command);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* SALTUS_H */
