//! The joint estimate of motion, transforms, clocks, rig and instrument errors from the raw readings: a continuous-time batch
//! adjustment (Furgale, Barfoot & Sibley 2012) by Gauss–Newton steps with robust weights.
//!
//! # State vector
//! | symbol | size | content | prior | code |
//! |---|---|---|---|---|
//! | θ | 36 a deployment | (x, y, z, yaw) `t_i`, `ψ_i` of stations 2 and 3 (m, rad) | none | [`state_vector`] |
//! | | | clock offsets `τ_i` (s) and drifts `δ_i` of stations 2 and 3; latencies `λ_i` of the angles (s) | N(0, σ²) | [`priors`] |
//! | | | distances `d_ab` of the prisms (m) | N(measured, σ²) | |
//! | | | leans `η_i`, `ξ_i` of the stations about their own x and y (rad) | N(earth's curvature, σ²); zero mean for station 1 | |
//! | | | range offsets `a_i` (m) and scales `k_i`, vertical index errors `ι_i` and collimation errors `κ_i` (rad) | N(0, σ²) | |
//! | s_b | 19 a block | changes of (x, y, z, yaw) of stations 2 and 3 and of their clocks | random walks from the set-up | [`random_walks`] |
//! | | | errors of the sights of stations 1 to 3 along, across and upward (m) | Gauss–Markov processes | |
//! | δ | 14 | changes of poses and leans between the survey and the drive | settling | [`survey_change`] |
//! | c | 9 or 3 a knot | coefficients of uniform cubic B-splines of three prisms, or of the one that all stations follow (m) | jerk | [`knot_grid`] |
//!
//! The standard deviations σ of the priors are the [`ErrorSizes`](super::ErrorSizes). The reference is station 1's level frame: `t_1`, `ψ_1`, `τ_1` and
//! `δ_1` are zero, while its leans, latency and instrument errors are estimated. a, k, ι and κ are reading minus truth: with `κ > 0` the line of sight
//! points right of the prism. `τ > 0` are late stamps, `λ > 0` older angles.
//!
//! A segment is an unbroken span of at most 100 knots; knots are as far apart as the readings of the slowest station. A block is a span of 6 to 12 s and at least
//! 16 knots in which s is constant. Blocks are 30 s or a whole segment where six seconds leave the normal matrix singular. The random walks of the poses
//! are correlated, because station 1 settles as well ([`settling`]).
//!
//! # Measurement equations
//! At its stamp t, station i reads a range ρ and two angles: the point `ρ e` in its own axes, with unit vectors e along the sight, n upward across it and
//! r to the right. Corrected for the instrument, with the refraction coefficient 0.13 and the earth's radius `R_E`, the point is ([`station_model`])
//!
//! ```text
//! p = (ρ (1 − k_i) − a_i) e + ρ (ι_i − 0.13 ρ / 2R_E) n − ρ κ_i r
//! ```
//!
//! In the frame of station 1 it is at `R_i p + t_i + Δt_ib`, with `R_i = Rz(ψ_i) · Rot(η_i, ξ_i)` and the displacement `Δt_ib` of its block. The prism is at
//! `q(t′) = Σ B_k(t′) c_k`, with the basis splines `B_k` and `t′ = t − τ_i − Δτ_ib − δ_i (t − t_middle)`. The angles are older than the range by
//! `λ_i`, during which the prism moves with its velocity across the sight `v⊥`. The residual in the axes `A = R_i [e r n]` is ([`residuals`])
//!
//! ```text
//! z = Aᵀ (q(t′) − λ_i v⊥ − R_i p − t_i − Δt_ib),   cov z = diag(σ_ρ², (ρ σ_α)², (ρ σ_α)²) + σ_t² Aᵀv vᵀA
//! ```
//!
//! with `σ_ρ = f (2 mm + 2 ppm ρ)` and the noise `σ_t` of the stamp. Two more equations tie the splines. Once a knot, `‖q_a − q_b‖ − d_ab` has the flexibility of
//! the rig, `σ_rig = 1.5 mm` with the facets of the prisms. From knot to knot of length h the jerk `(c_{k+3} − 3 c_{k+2} + 3 c_{k+1} − c_k) / h³` has the standard deviation σ_j.
//!
//! Errors of prisms that repeat with the incidence are not estimated. Their effect is added to the covariance of the poses ([`facets`]).
//!
//! Control points are adjusted on their own ([`mod@survey_adjustment`]). Their estimate and information are one more quadratic cost of θ, from which δ is
//! eliminated. The drive is nearly solved before it is added, and the prior of δ is widened for a station that changed.
//!
//! # Cost
//! ```text
//! Σ_readings w zᵀ (cov z)⁻¹ z + Σ_knots (‖q_a − q_b‖ − d_ab)² / σ_rig² + Σ_knots w ‖jerk‖² / σ_j²
//!   + (θ − θ₀)ᵀ P (θ − θ₀) + sᵀ P_s s
//! ```
//!
//! P is diag(1/σ²), zero for the transforms; θ₀ are the prior means; P_s is the precision of the random walks and processes. The robust weights w are
//! Cauchy's ([`loss`]): one for the three numbers of a reading, by `zᵀ (cov z)⁻¹ z / 3r` with the mean redundancy number r, and one for the jerks of a knot.
//!
//! The noise levels f, σ_α and σ_t are variance components, estimated as Helmert's with redundancy numbers from random probes (Girard 1989). σ_j is
//! estimated by expectation maximisation ([`noise_levels`]). The variances in P_s of slow errors and clocks are chosen from a few values by their
//! [marginal likelihood](marginal_likelihood).
//!
//! # Elimination
//! 1. The readings of a block depend on θ and s_b through 14 unknowns `u_b`: shifts and clock offsets of stations 2 and 3, latencies, distances. Instrument
//!    errors shift a station by one vector a block, by its mean sight; a shift of station 1 is the opposite shift of stations 2 and 3. This is an
//!    approximation of the Jacobians alone, `∂u_b = J_θ ∂θ + J_s ∂s_b` ([`block_jacobians`]): residuals have θ exactly, and `Δt_ib`, `Δτ_ib` are rows of `J_s s_b`.
//! 2. The motion c is eliminated from each segment, a banded matrix with the columns of u_b as border ([`equations`], [`motion_band`]). Its Schur complement
//!    couples each block to the next.
//! 3. With J_θ and J_s it becomes a block tridiagonal matrix in s_b with θ as border, the [`chain`], to which the priors are added. The slow
//!    states are eliminated from the first block on, which leaves 36 equations for θ ([`chain_factor`]).
//! 4. Back substitution gives s_b, then c ([`gauss_newton_step`]).
//!
//! The kernels of steps 2 and 3 are in [`linear_algebra`](crate::linear_algebra).
//!
//! # Iteration
//! [`mod@estimate`] starts from the transforms of a published method, the measured distances, and splines through the triplets.
//!
//! 1. It learns the noise levels on a sample of the drive, where the transforms have a prior of 0.1 m and 2 mrad.
//! 2. It steps with robust weights that follow the residuals. Near the solution it searches for slow changes: variances of P_s, and steps of stations and clocks
//!    ([`detected_steps`], [`step_search`]). It searches twice, and again while a search detects a step.
//! 3. It steps with fixed weights until a Gauss–Newton step is small (converged), or after 40 steps (not converged). While the steps shrink tenfold, it reuses the
//!    normal matrix and computes [`gradients`] alone.
//!
//! Far from the solution a normal matrix may be positive definite only with tighter priors of the slow states. If the last one is such a matrix, σ would be too
//! small, and longer blocks are tried. The [`Trace`] has a row a step, and the [`SolverStatus`] at the end.
//!
//! # Results
//! | file | content |
//! |---|---|
//! | [`joint_estimate`], [`summary`] | values, covariance and variance budget |
//! | [`facets`] | covariance by errors that repeat with the incidence on the prisms |
//! | [`reliability`] | redundancy numbers, minimal detectable biases and their effect |
//! | [`prior_conflict`], [`stated_size_conflict`] | tests of the priors |
//! | [`findings`] | findings and doubts |
//! | [`instrument_errors`] | errors of instruments with names and symbols |
//! | [`corrected_triplets`] | triplets without the estimated errors |
//! | [`prism_motion`], [`knot_covariance`], [`cut_motion`] | the motion at any instant with its covariance |
//! | [`mod@predict`] | the covariance before a drive |
//!
//! A new instrument error has a place in [`state_vector`], [`station_model`], [`block_jacobians`], [`priors`], [`summary`], [`joint_estimate`],
//! [`prior_conflict`], [`instrument_errors`] and [`corrected_triplets`].
//!
//! # Names
//! `x_by_y` is the Jacobian of x with respect to y. Slots 0 and 1 are stations 2 and 3. Gauss–Newton steps are subtracted. `information` is an inverse
//! covariance, `precision` 1/σ² of a prior. A knot has `LOCAL` coefficients.

mod block_jacobians;
mod chain;
mod chain_factor;
mod constants_prior;
mod corrected_triplets;
mod cut_motion;
mod detected_steps;
mod drive;
mod equations;
mod estimate;
mod facets;
pub mod findings;
mod gauss_newton_step;
mod gradients;
mod instrument_error_kind;
pub mod instrument_errors;
mod joint_estimate;
mod knot_covariance;
mod knot_grid;
mod linearisation;
pub mod loss;
mod marginal_likelihood;
mod motion_band;
mod noise_levels;
mod predict;
mod prior_conflict;
mod priors;
pub mod prism_motion;
mod random_walks;
pub mod reliability;
mod residuals;
mod settling;
mod solver_status;
mod state_vector;
mod stated_size_conflict;
mod station_model;
mod step_fit;
mod step_search;
mod summary;
pub mod survey;
pub mod survey_adjustment;
mod survey_change;
mod survey_elimination;
mod trace;

pub use self::estimate::{JointInput, estimate};
pub use self::joint_estimate::{DriveClocks, JointEstimate, LargestSource, SurveyPoses};
pub use self::predict::{ExpectedNoise, predict};
pub use self::priors::RigDistances;
pub use self::random_walks::GaussMarkov;
pub use self::residuals::{
    NoiseLevels, OBSERVED_DISTANCE_SIGMA_M, RIG_FLEX_SIGMA_M, stated_range_m,
};
pub use self::solver_status::SolverStatus;
pub use self::step_search::{StationStep, StepSize};
pub use self::survey::Survey;
pub use self::survey_change::SetUpChange;
pub use self::trace::{SlowChanges, SolverPhase, Trace, TraceEvent, TraceRow};
