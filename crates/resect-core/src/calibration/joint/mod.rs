//! The joint estimate of motion, transforms, clocks, rig and instrument errors from the raw readings: a continuous-time batch
//! adjustment (Furgale, Barfoot & Sibley 2012) by Gauss–Newton steps with robust weights.
//!
//! Lines of code name the equations that they compute: `// (3)`. A symbol has one meaning on this page, in the files of this module,
//! and in tables and JSON.
//!
//! # State vector
//! Each station i follows one of the prisms; several may follow the same one. Sizes are those of three stations with a prism each.
//!
//! | symbol | size | content | prior | code |
//! |---|---|---|---|---|
//! | θ | 42 a deployment | positions `o_i` = (x, y, z) (m) and yaws `ψ_i` (rad) of all stations but the first | none | [`unknown`] |
//! | | | clock offsets `Δt_i` (s) and drifts `Δf_i` of these stations; latencies `λ_i` of the angles (s) | N(0, σ²) | [`priors`] |
//! | | | distances `d_jl` of prisms j and l (m) | N(measured, σ²), correlated by the prism constant of their reading (10 mm) | |
//! | | | leans `η_i`, `ξ_i` of the stations about their own x and y (rad) | N(earth's curvature, σ²); zero mean for station 1 | |
//! | | | range offsets `a_i` (m) and scales `k_i`, vertical index errors `ι_i` and collimation errors `κ_i` (rad) | N(0, σ²) | |
//! | | | coefficients of refraction beyond 0.13 upward `β_i`, and to the right `ζ_i` | N(0, σ²) | |
//! | `s_b` | 19 a block b | changes of (x, y, z, yaw) and of the clocks of all stations but the first | (10) | [`random_walks`] |
//! | | | errors of the sights of the stations along, across and upward (m) | (11) | |
//! | Δθ | 14 | poses of all stations but the first and leans, survey less drive | N(0, D): settling, and σ² of a lean | [`survey_change`] |
//! | `c_n` | 9 a knot n | coefficients of uniform cubic B-splines of the prisms that are followed (m) | (9) | [`knot_grid`], [`segment_prisms`] |
//!
//! The rows of [`unknown`] are the kinds of θ. [`state_vector`] computes the index of each from them and from the network.
//!
//! The standard deviations σ of the priors are the [`ErrorSizes`](super::ErrorSizes). A distance that is no evidence has 0.1 m. The reference is
//! station 1's level frame: its position, yaw and clock are zero, while its leans, latency and instrument errors are estimated. a, k, ι
//! and κ are reading minus truth, ι of a zenith angle: with `κ > 0` the line of sight points right of the prism. `Δt > 0` are late
//! stamps, `λ > 0` older angles.
//!
//! All readings are taken that the user does not exclude and that fit the start (step 0 below), each at its own time. A prism is followed while its
//! readings are at most 2 s apart, by whichever stations. A span of time with the same followed prisms is cut into segments of at most 100 knots
//! ([`spans`]). Prisms that nobody follows have no unknowns there. The knot interval h is the median time between readings of the
//! slowest station, and at least 0.1 s.
//! A segment has blocks of equal length, in which s is constant. Each is one to two times as long as the longer of 6 s and 16 knot intervals; a
//! shorter segment is one block. If these blocks give no estimate, because a matrix is singular or the iteration diverges, blocks of
//! 30 s are tried, and then whole segments.
//!
//! # Measurement equations
//! At its stamp t, station i reads a range ρ and two angles: the point `ρ e_ρ` in its own axes. The unit vectors are `e_ρ` along the sight,
//! `e_h` to the right and `e_v` upward across it. Corrected for the instrument, with the refraction coefficient 0.13 and the earth's radius
//! `R_E`, the point is p ([`station_model`]). `R_i` rotates it to the axes of station 1:
//!
//! ```text
//! p = (ρ (1 − k_i) − a_i) e_ρ + ρ (ι_i − (0.13 + β_i) ρ / 2R_E) e_v − ρ (κ_i + ζ_i ρ / 2R_E) e_h   (1)
//! R_i = Rz(ψ_i) Rot(η_i, ξ_i)                                                                 (2)
//! ```
//!
//! The prism is at `q(t′)`, with the basis splines `B_n`. Its time t′ has the middle `t_m` of the drive:
//!
//! ```text
//! t′ = t − Δt_i − Δf_i (t − t_m) − sᵗ_ib                                                      (3)
//! q(t′) = Σ B_n(t′) c_n                                                                       (4)
//! ```
//!
//! `sᵗ_ib` (s) and the displacement `sᵒ_ib` (m) are rows of `J_s s_b` (19). For station 1, and for the reference of a block, they are zero. The block b is
//! that of t′ without `sᵗ_ib`. The angles are older than the range by `λ_i`, during which the prism moves with its velocity across the
//! sight `v⊥`. The residual in the axes `A = R_i [e_ρ e_h e_v]` is ([`residuals`])
//!
//! ```text
//! ε = Aᵀ (q(t′) − λ_i v⊥(t′) − R_i p − o_i − sᵒ_ib)                                           (5)
//! cov ε = diag(σ_ρ², (ρ σ_h)², (ρ σ_v)²) + σ_t² Aᵀv vᵀA                                       (6)
//! σ_ρ = f_ρ (2 mm + 2 ppm ρ)                                                                  (7)
//! ```
//!
//! with the noise `σ_h` of horizontal angles, `σ_v` of vertical ones, and `σ_t` of the stamp. Two more equations tie the splines. Once a knot interval, a distance of the rig has the standard
//! deviation `σ_rig`: 1.5 mm √(1.5 s / h) with the facets of the prisms, which show the same error for about 1.5 s, or 0.35 mm of flexibility if `ranges_wander`
//! is off. From knot to knot the jerk has
//! the standard deviation `σ_jerk`, one for horizontal coordinates and one for heights:
//!
//! ```text
//! ‖q_j − q_l‖ − d_jl ~ N(0, σ_rig²)                                                           (8)
//! jerk = (c_{n+3} − 3 c_{n+2} + 3 c_{n+1} − c_n) / h³ ~ N(0, σ_jerk² + ν_n²)                  (9)
//! ```
//!
//! `ν_n`, as `σ_jerk`, is the jerk beyond the usual one, where the readings themselves show that the vehicle starts, stops or turns sharply ([`excess_jerk`]).
//!
//! # Slow states
//! Poses and clocks are random walks from the set-up. Their increments have a share ω of the variance of a whole drive, with the middles `t_b` of
//! the blocks: `t_b − t_{b−1}` over the length of the drive, and half of a mean block from the set-up to the first. ω is 1 before a further
//! drive, where the clocks have 1 s, and 10⁴ at a detected step. Q is the variance of poses relative to station 1, which settles as well, with the Jacobian `J_1` by its pose ([`settling`]):
//!
//! ```text
//! s_b − s_{b−1} ~ N(0, ω Q),  Q = diag(σ², σ²) + J_1 diag(σ²) J_1ᵀ  (poses),  Q = σ²  (a clock)   (10)
//! ```
//!
//! Errors of the sights are Gauss–Markov processes with standard deviations `σ_sρ`, `σ_sh`, `σ_sv` and correlation times `T_s`:
//!
//! ```text
//! s_b ~ N(μ s_{b−1}, σ_s² (1 − μ²)),  μ = exp(−(t_b − t_{b−1}) / T_s)                         (11)
//! ```
//!
//! Errors of prisms that repeat with the incidence are not estimated. Their effect is added to the covariance of poses and constants
//! ([`mod@facet_covariance`]).
//!
//! # Survey
//! Control points are adjusted on their own ([`mod@adjust_survey`]), with the estimate θ̂. An offset of a station's ranges, and a station that
//! moved between two sets, are tested ([`survey_conflicts`]). The readings alone have the
//! information Λ and the gradient γ there. They observe `θ + Δθ`. Elimination of Δθ leaves a quadratic cost of θ, with the columns `Λ_Δ`
//! of poses and leans ([`survey_change`]):
//!
//! ```text
//! M = Λ − Λ_Δ (Λ_ΔΔ + D⁻¹)⁻¹ Λ_Δᵀ,  γ_M = γ − Λ_Δ (Λ_ΔΔ + D⁻¹)⁻¹ γ_Δ
//! (θ − θ̂)ᵀ M (θ − θ̂) + 2 γ_Mᵀ (θ − θ̂)                                                         (12)
//! ```
//!
//! # Cost
//! The robust loss ℓ of a mean square m and its weight w are Cauchy's ([`loss`]):
//!
//! ```text
//! ℓ(m) = 2.4² ln(1 + m / 2.4²),  w(m) = ℓ′(m) = 1 / (1 + m / 2.4²)                            (13)
//!
//! Φ = Σ_readings 3r ℓ(εᵀ (cov ε)⁻¹ ε / 3r) + r ln(1 + σ_t² vᵀ (cov ε − σ_t² v vᵀ)⁻¹ v) + Σ_knots 9 ℓ(Σ jerk² / (σ_jerk² + ν_n²) / 9)
//!   + Σ_knots (‖q_j − q_l‖ − d_jl)² / σ_rig² + (θ − θ₀)ᵀ P (θ − θ₀) + sᵀ P_s s + (12)         (14)
//! ```
//!
//! with three coordinates a prism instead of 9, and the mean redundancy number r of a reading (16). Fixed weights replace `ℓ(m)` by `w m`. P is the
//! precision of the priors of θ, zero for the transforms; θ₀ are their means; `P_s` is the precision of (10) and (11).
//!
//! # Noise levels
//! The levels `f_ρ`, `σ_h`, `σ_v` and `σ_t` are variance components, estimated as Helmert's ([`noise_levels`]). One σ of a kind displaces a reading by ς:
//! `(σ_ρ, 0, 0)`, `(0, ρ σ_h, 0)`, `(0, 0, ρ σ_v)`, or `σ_t Aᵀv`. The motion absorbs a part of the expected squares, estimated by random
//! probes (Girard 1989):
//!
//! ```text
//! observed = Σ w² (ςᵀ (cov ε)⁻¹ ε)²,  expected = Σ w² ςᵀ (cov ε)⁻¹ ς,
//! level² ← level² observed / 0.70 (expected − absorbed)                                       (15)
//! r = 1 − absorbed / expected  (of ranges and angles together)                                (16)
//! ```
//!
//! The factor 0.70 is the consistency of the weighted squares. `σ_jerk` is estimated by expectation maximisation, extrapolated by the redundancy number `r_jerk`
//! of the jerks (at least 0.25). Their squares are unweighted, and their number is expected:
//!
//! ```text
//! σ_jerk ← σ_jerk ((Σ jerk² / σ_jerk² + absorbed) / expected)^(1 / 2r_jerk)                   (17)
//! ```
//!
//! Jerks with `ν_n > σ_jerk` are left out of (17). A step changes a level by a factor of at most 2.7, within limits.
//!
//! The variances in `P_s` of errors of the sights and clocks are chosen from a few values by their [marginal likelihood](marginal_likelihood). g is the
//! gradient of Φ/2, and H the normal matrix of the data, both without the motion:
//!
//! ```text
//! −2 ln L = ln|H + P + P_s + M| − ln|P_s| + sᵀ P_s s − gᵀ (H + P + P_s + M)⁻¹ g + constant    (18)
//! ```
//!
//! # Elimination
//! 1. The readings of a block depend on θ and `s_b` through 14 unknowns `u_b`: shifts and clock offsets of all stations but the first, latencies, distances
//!    ([`block_jacobians`]):
//!
//!    ```text
//!    ∂u_b = J_θ ∂θ + J_s ∂s_b                                                                 (19)
//!    ```
//!
//! 2. The motion c is eliminated from each segment, a banded matrix with the columns of `u_b` as border ([`equations`], [`motion_band`]). Its Schur complement
//!    couples each block to the next.
//! 3. With `J_θ` and `J_s` it becomes a block tridiagonal matrix in `s_b` with θ as border, the [`chain`], to which the priors are added. The slow
//!    states are eliminated from the first block on, which leaves equations for θ ([`chain_factor`]). If the matrix is not positive
//!    definite, it is factorised with a millionfold `P_s`.
//! 4. Back substitution gives `s_b`, then c ([`gauss_newton_step`]).
//!
//! The kernels of steps 2 and 3 are in [`linear_algebra`](crate::linear_algebra).
//!
//! # Approximations
//! Residuals (5) have θ and c exactly, while two approximations simplify the normal matrix.
//!
//! **Jacobians** (19), for these changes:
//!
//! | change | Jacobian |
//! |---|---|
//! | positions, clock offsets, latencies, distances | of each reading |
//! | slow changes and slow errors | of each reading, because `sᵒ_ib` is defined by the mean sight of the block |
//! | drifts | at the middle of the block |
//! | yaws, leans, range offsets, scales, vertical index and collimation errors | one shift of the station, by the mean sight of the block |
//! | the same errors of the reference | the opposite shift of all others; leans, collimation and yaw rotate their points about it |
//!
//! The reference of a block is the first station that has readings there: station 1 as a rule. The motion c has its errors.
//!
//! Changes of A, v and `v⊥` with the state are neglected in all Jacobians. The information that sights differ within a block is not used.
//!
//! **Schur complement** of step 2: its border has the columns of two blocks. A remaining coupling of block b is added to block b + 2
//! when that begins. The complement is exact for changes that all blocks have in common. It is approximate for those of
//! single blocks: slow states, and θ as far as `J_θ` differs from block to block.
//!
//! The steps stop where the gradients vanish ([`gradients`]):
//!
//! ```text
//! ∂Φ/∂c = 0,  Σ_b J_θᵀ ∂Φ/∂u_b + ∂Φ/∂θ = 0,  J_sᵀ ∂Φ/∂u_b + ∂Φ/∂s_b = 0                        (20)
//! ```
//!
//! with ∂Φ/∂u of the data by the Jacobians above, ∂Φ/∂θ and ∂Φ/∂s of the priors. `∂Φ/∂c = 0` removes the Schur complement from (20), so its approximation changes
//! covariances and convergence alone. The Jacobians (19) remain: (20) is not the minimum of Φ. At the true state, residuals have zero mean, and
//! so has (20) with any Jacobian. Errors of (19) therefore cause no bias of first order, but information is lost. Covariances are the inverse
//! of the approximate normal matrix.
//!
//! # Iteration
//! [`mod@estimate`] starts from the transforms of a published method, the measured distances, and splines through the readings.
//!
//! 0. It leaves out readings whose distances to those of other stations, interpolated to their time, contradict the start. Of two that contradict each
//!    other, the one that fits more other stations is kept; neither, if they fit as many. A run of half a second of which less than three quarters are
//!    kept is left out as a whole. Where one other station alone sees the rig, so is a run that clearly fits another prism. A station alone has no such
//!    test.
//! 1. It learns the noise levels on a sample of about 600 knots, where the transforms have a prior of 0.1 m and 2 mrad: after two steps of the
//!    motion alone, and three times again after a step of all unknowns. The levels are constant from then on.
//! 2. It steps with robust weights that follow the residuals. Near the solution it searches for slow changes: once no constant moves by more
//!    than 1.5 σ, and the squared length of a step (21) is below 4, times the knots of the drive over those of the sample (their root for σ). It
//!    searches twice, and again while a search detects a step.
//! 3. It steps with fixed weights until a step is small (converged), or after 40 steps of parts 2 and 3 (not converged). An estimate with a station 30 m
//!    from the published answer has diverged.
//!
//! A step (∂θ, ∂s) is small if its squared length is, by the normal matrix of data and survey:
//!
//! ```text
//! (∂θ, ∂s)ᵀ (H + M) (∂θ, ∂s) < 0.004                                                          (21)
//! ```
//!
//! Drives of more than 100 blocks may have as much for every 100 of them, if no constant moves by more than the root of 0.004 σ. After 25 steps, 0.1
//! instead of 0.004 is small enough.
//!
//! Part 3 reuses the normal matrix and computes [`gradients`] alone while the steps shrink at least by a factor of 3.2: their squared length
//! by a factor of 10. It begins so if the last squared length of part 2 is below 10. Drives of more than 4096 knots never reuse it.
//!
//! **Step control.** After a step that does not keep Φ below 1.01 times its value, the iteration returns to the state before it. It
//! linearises there again, and applies a quarter of the share. The next step has twice the share of the last one, and at most all. With fixed weights there
//! are two exceptions, for steps longer than 0.6 times the last one. If they turn back (cosine of the angle below -0.8), the share is halved. If they
//! keep their direction (above 0.8), the sum of all further steps is taken, which is ten steps at most (Aitken 1926). θ and s take the share, to which the motion is fitted. A share below 0.001 is
//! accepted in any case. The cost may rise by 1 %, because (20) is not the minimum of Φ. Before it is compared, a step of the motion alone follows
//! the sights within the blocks, which (19) neglects. Steps of coefficients that the readings hardly determine are shortened: 1/(0.3 m)² is
//! added to the diagonal of the motion (Levenberg 1944). Steps that reuse the normal matrix are
//! not controlled. A new normal matrix after them compares Φ with the data's cost at the one before.
//!
//! **Searches** solve the same normal equations with other priors, in this order:
//! - Priors of clock offsets are widened to 1 s if the data rejects them, unless the user stated a smaller σ than the default. The test needs data
//!   that reduces the prior variance by more than 5 %. With the posterior variance C it is
//!
//!   ```text
//!   Δt_i² > 4² (σ² − C)                                                                       (22)
//!   ```
//!
//! - The first search adds the survey. If the drive alone does not determine the answer, or did not converge, the survey is used from the first
//!   step on. D is widened once: for the station whose change is significant, also with the facets F, or for all that may have changed. With the Jacobian `J_i` of the poses by that of station i, and the fitted change (Δo, Δψ):
//!
//!   ```text
//!   D ← D + J_i diag(max(5 mm, |Δo|)², max(2 mrad, |Δψ|)²) J_iᵀ                                 (23)
//!   ```
//!
//! - Standard deviations and correlation times of (11) are replaced by likelier ones (18), and the variance of the clocks in (10): before steps are
//!   detected, so that stamps that wander are no steps, and after it.
//! - Steps of stations and clocks are detected, four at most ([`detected_steps`], [`step_search`]). With the precision `(ωQ)⁻¹` of an increment
//!   Δs and its posterior covariance C, the data alone has this normal matrix and right-hand side:
//!
//!   ```text
//!   (ωQ)⁻¹ − (ωQ)⁻¹ C (ωQ)⁻¹,  (ωQ)⁻¹ Δs                                                      (24)
//!   ```
//!
//!   The covariance of the second is the first, and that of errors which (11) does not have: 1.5 mm of each sight along each axis, because a vehicle
//!   that starts to move changes the incidence at once, and the facets where a step is significant without them.
//!
//! Far from the solution a normal matrix may be positive definite only with tighter priors of the slow states. If the last one is such a matrix, σ would be too
//! small, and longer blocks are tried. The [`Trace`] has a row a step, and the [`SolverStatus`] at the end.
//!
//! # Results
//! The answer is the mean pose of each station over the blocks of the drive. Its posterior covariance C is enlarged by the variance of a random
//! walk's mean about its start, and by that of the facets F:
//!
//! ```text
//! (o_i, ψ_i) + mean_b s_b,  covariance C + Q / 3 + F                                          (25)
//! ```
//!
//! F has the linear effect of each coefficient of the errors, and that of the second order as the mean over random draws. The facets are no noise: heights
//! respond to them by the Hessian (27). The constants θ have such a
//! covariance as well, with which the poses of the vehicle are computed ([`mod@facet_covariance`]).
//!
//! The normal matrix counts noise of the vehicle's tilts as information on heights. C, F and the covariance of θ are those of the Hessian instead, as far as
//! it differs for heights (27) ([`mod@height_curvature`]). Where less than a fifth of the information on heights is no noise, they are not determined.
//!
//! # Rival
//! On flat ground a mirrored solution fits as well. If neither the rig nor control points exclude it, the iteration starts there with the noise
//! levels and priors of the estimate, and with robust weights of its own ([`rival`]). The likelihoods decide from this difference of Φ on,
//! for a drive with n knots, of which a share h / 1.5 s has independent facets:
//!
//! ```text
//! |Φ(rival) − Φ(estimate)| > 25 + 0.3 n min(h / 1.5 s, 1)                                     (26)
//! ```
//!
//! The estimate that starts from the rival must agree, by its own levels and priors. If the iteration returns to the estimate, there is no rival.
//!
//! Tables and JSON have these symbols with the number of the station. Their `σ_ρ` is that of a range of length zero, and Δx is survey less drive as Δθ.
//!
//! | file | content |
//! |---|---|
//! | [`joint_estimate`], [`summary`] | values, covariance and variance budget |
//! | [`facets`], [`mod@facet_covariance`] | errors that repeat with the incidence on the prisms, and the covariance by them |
//! | [`mod@height_curvature`] | covariance of heights by the Hessian |
//! | [`reliability`] | redundancy numbers, minimal detectable biases and their effect |
//! | [`rival`] | comparison with the mirrored solution |
//! | [`unseen_errors`] | covariance of a position by one station |
//! | [`prior_conflict`], [`stated_size_conflict`] | tests of the priors |
//! | [`findings`] | findings and doubts |
//! | [`instrument_errors`] | errors of instruments with names and symbols |
//! | [`corrected_triplets`] | triplets without the estimated errors |
//! | [`prism_motion`], [`knot_covariance`], [`cut_motion`] | the motion at any instant with its covariance |
//! | [`mod@predict`] | the covariance before a drive |
//!
//! A new error of the instruments is a row of [`unknown`].
//!
//! # Names
//! `x_by_y` is the Jacobian of x with respect to y. Slots 0, 1, … are stations 2, 3, …. Gauss–Newton steps are subtracted. `information` is an inverse
//! covariance, `precision` 1/σ² of a prior.

pub mod adjust_survey;
mod attempt_end;
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
mod excess_jerk;
mod facet_covariance;
mod facets;
pub mod findings;
mod gauss_newton_step;
mod gradients;
mod height_curvature;
pub mod instrument_errors;
mod joint_estimate;
mod knot_covariance;
mod knot_grid;
mod learned_noise;
mod linearisation;
pub mod loss;
mod marginal_likelihood;
mod motion_band;
mod noise_levels;
mod predict;
pub mod prior_conflict;
mod priors;
pub mod prism_motion;
mod prisms_of_instant;
mod random_walks;
mod readings;
pub mod reliability;
mod residuals;
mod rival;
mod segment_prisms;
mod settling;
mod sight;
mod solver_status;
mod spans;
mod state_vector;
mod stated_size_conflict;
mod station_model;
mod step_control;
mod step_fit;
mod step_search;
mod summary;
pub mod survey;
mod survey_adjustment;
mod survey_change;
mod survey_conflicts;
mod survey_elimination;
mod survey_markers;
mod survey_reliability;
mod tested_error;
mod trace;
pub mod unknown;
mod unseen_errors;

pub use self::estimate::{JointInput, estimate};
pub use self::joint_estimate::{DriveClocks, JointEstimate, LargestSource, SurveyPoses};
pub use self::predict::{ExpectedNoise, predict};
pub use self::priors::RigDistances;
pub use self::random_walks::GaussMarkov;
pub use self::readings::{DriveReadings, Reading, STEPS_APART};
pub use self::residuals::{
    NoiseLevels, OBSERVED_DISTANCE_SIGMA_M, RIG_FLEX_SIGMA_M, stated_range_m,
};
pub use self::rival::{decisive_excess, excess_of};
pub use self::settling::relative_settling;
pub use self::sight::Sight;
pub use self::solver_status::SolverStatus;
pub use self::state_vector::Layout;
pub use self::step_search::{StationStep, StepSize};
pub use self::survey::Survey;
pub use self::survey_change::SetUpChange;
pub use self::trace::{SlowChanges, SolverPhase, Trace, TraceEvent, TraceRow};
pub use self::unseen_errors::{shared_errors_m, unseen_covariance_m2};
