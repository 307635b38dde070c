"""All numerical options of the critic, and the ones in force."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Options:
    """The numbers that a diagnosis depends on, by the part that uses them; in brackets their size for SWAMP.

    Units: SI and rad; chi2 is -2 log likelihood; L, U: a boat's length and top speed. What an effect must
    save is the information criterion's to say (`information_criterion.py`). Numbers without a reason beside
    them were chosen on simulated cases (`benchmarks/blind`). Constants of probability and formats of files
    are no options.
    """

    # ---- Data that no diagnosis is possible from
    shortest_run: float = 10.0  # s of a run: the horizon that causes are judged at
    least_data: float = 20.0  # s of all such runs together: two of the shortest
    step_slack: float = 1.05  # ratio by which a sample step may exceed the shortest of `horizons`
    running_throttle: float = 0.02  # of full throttle from which a thruster runs
    track_mean: float = 5.0  # s of the means that suppress noise in the range of a track
    still_lengths: float = 0.806  # boat lengths of range, below which a boat stands still (2 m of SWAMP)
    still_turn: float = 0.5  # rad of range, below which a boat does not turn, beyond which its sensors do
    # ---- Columns that contradict each other
    slope_span: float = 0.5  # s to either side of a central difference
    slope_span_rough: float = 2.0  # s of the same where positions are rough
    longest_lag: float = 2.0  # s between columns that are looked for
    rough_positions: float = 0.121  # boat lengths of scatter between samples of rough positions (0.3 m)
    reading_poor: float = 0.3  # share of power explained as it stands, up to which another reading is tried
    reading_good: float = 0.7  # share by another reading, or more than as it stands, that is refused
    out_of_step: float = 0.3  # s of lag that is refused; less is the effect `position_delay`
    moved_lengths: float = 4.03  # boat lengths of range at which a constant sensor is refused (10 m of SWAMP)
    lag_improvement: float = 0.5  # of the unexplained power that a lag must leave at most
    # ---- Excitation that the runs lack (advice alone: no diagnosis depends on it)
    speed_span: float = 2.0  # s of the differences that give speed and turning rate
    least_way: float = 0.0722  # top speeds of a boat under way (0.1 m/s of SWAMP)
    speeds_apart: float = 1.4  # ratio of two speeds that count as different: forces differ by its square, 2
    least_turning: float = 0.0447  # U/L of a boat that turns (0.025 rad/s of SWAMP)
    least_share: float = 0.05  # of the time, least duration of a motion
    running_command: float = 0.02  # of the largest command of any thruster, from which one runs
    least_steering: float = 0.1  # rad of range of an azimuth or a rudder
    least_throttle_range: float = 0.1  # of the largest level, range of a throttle that is stepped
    quadrants: int = 4  # of the compass, all of which are wanted
    # ---- Measurement noise and outliers
    # least sigma of a channel, in `state_scale`: the error of the integration
    noise_floor: tuple[float, ...] = (1.613e-3, 1.613e-3, 5e-4, 7.217e-4, 7.217e-4, 4.475e-4)
    difference_clip: float = 4.0  # sigmas beyond which a third difference is left out of the root mean square
    outlier: float = 6.0  # sigmas from the median of its neighbours: 2e-9 of normal noise
    outlier_neighbours: int = 7  # samples of that median
    slow_sensor: float = 0.6  # share of rows with a sample, below which differences are of samples alone
    # ---- The time grid
    grid_tolerance: float = 0.3  # of a sample step, largest distance of a row from the grid
    # ---- Simulation
    least_transient: float = 3.0  # s at a run's start, not compared: the actuators' state is not recorded
    actuators_converged: float = 0.01  # rad of azimuth, share of throttle by which two histories may differ
    # ---- Candidates
    grid_directions: int = 8  # of a vector's grid: 45 degrees apart
    most_group_parameters: int = 2  # parameters of an effect that may differ between groups
    most_groups: int = 24  # beyond which the normal equations grow too large
    duration: float = 60.0  # s of a run where none is given: bound of the instant of a failure
    # ---- The manoeuvre that is proposed
    zig_zag_period: float = 12.0  # s of a zig-zag
    # ---- Threads
    thread_steps: int = 1_500  # boat steps that are worth a thread: about 1 ms
    most_together: int = 4  # threads of Python: its lock is held for a third of their time
    switch_interval: float = 5e-4  # s until a thread gives way to another, a tenth of a simulation's time
    actuator_share: int = 5  # steps of actuators alone that take as long as one of a boat
    slope_share: int = 300  # numbers of a Jacobian that take as long as one
    # ---- Whiteness test of the residual
    whiteness_scales: tuple[float, ...] = (1.0, 4.0)  # s over which residuals are averaged
    variance_bias: float = 1.06  # relative bias of a variance estimated from differences
    nearly_noise: float = 1.2  # chi2 a sample up to which gaps and initial states may explain the residual
    whiteness_limit: float = 5.0  # standard deviations of the excess: 3e-7 in each of 12 tests
    least_means: int = 4  # means of a channel that its excess is judged by
    # ---- Held-out gain
    loss_resamples: int = 2000  # bootstrap samples of the intervals in the report's list of hypotheses
    enough_runs: int = 4  # runs that are folds and blocks; with fewer, parts of runs are
    largest_tilt: float = -1e3  # of the bootstrap's saddlepoint, beyond which the sum is its least
    least_tilt: float = -1e-3  # of it, where the sum is its mean
    stretch: float = 20.0  # s of a block of a long window or run that is resampled; at least two horizons
    held_out_rounds: int = 8  # iterations of the initial states of a held-out window
    tail: float = 0.025  # probability below an interval: 95 %
    # standard deviations of a principal component of the boat file's errors, of a finite difference
    errors_step: float = 0.1
    # ---- Sensitivity to forces
    # in `acceleration_scale`, of the finite difference
    acceleration_step: tuple[float, ...] = (6.46e-5, 6.46e-5, 8.01e-5)
    chunk_bytes: int = 2**26  # bytes of Jacobians or tracks that are computed at once
    observed_rows: int = 2**14  # rows of tracks measured at once: 0.8 MB, which a cache holds
    # ---- Gauss-Markov measurement noise
    wander_times: tuple[float, ...] = (1.0, 3.0, 10.0, 30.0, 100.0)  # s, time constants tried
    # standard deviations tried, in those of the white noise
    wander_sizes: tuple[float, ...] = tuple(0.15 * 2.0**k for k in range(12))
    wander_white: float = 0.05  # least white part of positions beside it, in that of third differences
    wander_step: float = 1e-4  # of the logarithms of size, time and white part, of the finite difference
    wander_gain: float = 25.0  # of 2 log likelihood: 5 standard errors
    # ---- Initial states
    smoothing_span: float = 1.0  # s to either side that an initial state is smoothed over
    smoothing_span_rough: float = 2.0  # s of the same for noisy positions
    clean_position: float = 0.0806  # boat lengths of noise up to which the shorter is used (0.2 m of SWAMP)
    # ---- Multiple shooting
    # of the simulator's: the step in whole runs, which magnify its error; Jacobians take the simulator's own
    substep_of_runs: float = 0.5
    pad: float = 1.0  # s simulated before a window's first sample, so that delays see what went before
    shortest_window: float = 1.5  # s of a window between gaps, below which it is not compared
    # least standard deviation of a smoothed state, in `state_scale`
    start_sd: tuple[float, ...] = (0.403, 0.403, 0.15, 0.361, 0.361, 0.268)
    start_sd_in_noise: float = 3.0  # the same in standard deviations of the noise
    most_histories: int = 12  # actuator histories that are kept
    most_tracks: int = 32  # tracks of all windows that are kept, to be asked for again
    most_scores: int = 4  # fits of windows whose score tests are kept, to be asked for again
    # in `state_scale`, of finite differences: unstable boats magnify them
    state_step: tuple[float, ...] = (8e-6, 8e-6, 1e-6, 7.2e-7, 7.2e-7, 8.9e-7)
    # ---- Levenberg-Marquardt of parameters and initial states
    dampings: tuple[float, ...] = (0.0, 1.0, 4.0, 16.0, 64.0)  # tried in turn, relative to a reach
    stray_window: float = 1.35  # times the median loss of a window whose initial state is refitted
    stray_rounds: int = 4  # iterations of that
    strays_one_in: int = 3  # windows, at most: where more are stray, it is the hypothesis that is wrong
    gain_ratio: float = 0.6  # below which a new Jacobian is taken
    gain_ratio_far: float = 0.9  # the same where a step gains more than `close_gain`
    close_gain: float = 30.0  # chi2 of such a step
    window_increase: float = 10.0  # chi2 by which a window may become worse unless its state is refitted
    # in `state_scale`: a large step of an initial state
    state_reach: tuple[float, ...] = (0.403, 0.403, 0.2, 0.144, 0.144, 0.179)
    state_gain: float = 2.0  # chi2 that refitting an initial state must promise at the end of a fit
    most_refits: int = 3  # continuations of a fit after that
    no_information: float = 1e42  # variance of a parameter that nothing depends on
    farthest_state: float = 4.0  # reaches: largest step of a window's state
    fit_steps: int = 8  # Jacobians of a fit
    again_steps: int = 6  # the same where little changed: commands, noise, or one function more
    check_steps: int = 4  # the same where only chi2 is asked for, or much is fitted
    glance_steps: int = 2  # the same of a fit that is expected to be worse by far
    part_steps: int = 1  # the same on a part of the windows, before score tests
    # ---- Prediction error
    horizons: tuple[float, ...] = (1.0, 5.0, 10.0, 30.0)  # s
    restart: float = 5.0  # s between restarts, at least
    error_resamples: int = 4000  # bootstrap samples
    # ---- Sandwich covariance
    score_stretch: float = 8.0  # s of a run whose scores are summed to one block
    fewest_blocks: int = 8  # blocks from which the scatter is estimated
    # ---- Levenberg-Marquardt window by window
    least_decrease: float = 0.3  # chi2: a step that lowers it by less ends a fit
    least_decrease_share: float = 5e-3  # of chi2 above noise: the same for a hypothesis far from the data
    noise_chi2: float = 1.1  # chi2 a sample that counts as noise there
    first_damping: float = 0.01  # Marquardt's, the first after a step that fails
    last_damping: float = 1.0  # above which a window whose initial state did not improve is left
    damping_factor: float = 10.0  # from one step to the next
    window_decrease: float = 0.03  # chi2 that a step of a window must promise: a tenth of `least_decrease`
    # ---- Commands during lost rows
    around_gap: float = 5.0  # s to either side of a gap that are compared
    negligible_gap: float = 2.0  # chi2 between the latest and the earliest change: less of a gap is ignored
    other_command_gain: float = 1.0  # chi2 by which another command must be better
    other_shares: tuple[float, ...] = (0.5, -1.0, 2.0)  # of the change: other commands that a gap may hide
    other_share_gain: float = 9.0  # chi2 that such a command must save: 3 standard errors
    longest_gap: int = 5  # rows: commands of longer gaps are not estimated
    returned_command: float = 0.01  # share of stretches as long that hide a change, from which one may
    jump_ratio: float = 2.0  # of a ramp as steep as beside a gap: a larger change over it is a jump
    gap_rounds: int = 5  # iterations for the initial state of each window
    # ---- Weights from the model error
    model_error_short: float = 10.0  # s: windows in which model error has grown little
    model_error_window: float = 30.0  # s: the longest horizon of prediction errors
    model_error_windows: int = 12  # windows of all runs together, at least
    model_error_rounds: int = 3  # repetitions of fit and estimate of the model error
    # ---- Process noise
    # sizes of forces that the estimate begins with, in `force_scale`
    process_reach: tuple[float, ...] = (0.102, 0.102, 0.0826)
    process_least: tuple[float, ...] = (2.05e-4, 2.05e-4, 1.65e-4)  # the least, in `force_scale`
    process_most: float = 10.0  # the most, in `force_scale`; of the curves' errors too
    variance_tolerance: float = 1e-6  # share of the deviance that a step to likelier variances must save
    process_piece: float = 2.0  # s that a force is constant in, at least
    process_pieces: int = 60  # of a window, at most
    process_times: tuple[float, ...] = (2.0, 8.0, 32.0)  # s, of which the most likely is taken
    # ---- Errors of the model's curves
    # in `force_scale`, sizes that the estimate begins with: of Gauss-Markov forces, of the curves' errors
    curve_errors_begin: tuple[float, float] = (0.01, 0.003)
    curve_errors_least: float = 1e-5  # the least of the curves' errors, in `force_scale`
    # ---- Random effects
    spreads: tuple[float, float, int] = (1e-4, 1e2, 121)  # typical sizes: least, largest and number tried
    # ---- Channels that a filter smoothed
    smoothed_step: float = 0.25  # L/U between samples [0.22 s], above which the motion fills the strides
    strides: tuple[int, ...] = (1, 2, 4, 8)  # samples, of the fit
    judged_stride: int = 3  # samples, of the recognition
    smoothed_ratio: float = 1.6  # least ratio of variances over that stride and over one: a pole of 0.35
    motion_exponent: float = 4.0  # of that ratio, from which it is the motion (6), no filter's noise (1 to 3)
    motion_certainty: float = 2.0  # standard errors of faster growth, from which a stride holds the motion
    first_order_exponent: float = 1.2  # up to which the filter is of first order, and lags behind the motion
    smoothed_certainty: float = 6.0  # standard errors of the ratio beside that
    rounding_noise: float = 1e-9  # of `state_scale`: less is the rounding of a simulation, no sensor's
    fewest_differences: int = 100  # third differences: their variance is known to a fifth
    least_inside: float = 0.8  # share of third differences within `difference_clip`, else they are a motion
    own_samples: float = 0.9  # share of rows with a sample of their own
    settled: float = 0.5  # s after a change of commands
    poles: tuple[float, float, int] = (0.2, 0.98, 79)  # least, largest and number of the poles tried
    # ---- Switching times
    share_step: float = 0.25  # of a share, of the finite difference
    most_instants: int = 60  # of a window up to the length of a middle one, those of the largest steps
    instants_steps: float = 1.5e6  # boat steps up to which a longer window has as many for its length
    smallest_change: float = 0.02  # rad or of full throttle: smaller steps are not fitted
    # ---- Commands that stood in lost rows alone
    command_step: float = 0.1  # rad or of full throttle, of the finite difference
    # rad and of full throttle, standard deviations of the prior of a change
    command_reach: tuple[float, float] = (1.5, 0.5)
    unlogged_gain: float = 40.0  # chi2 that a change must save: a run has tens of lost rows to choose from
    most_lost_rows: int = 60  # of a run, beyond which none is tried
    unlogged_limit: float = 2.0  # reaches, largest change
    # ---- Elimination and rivals
    strong_evidence: float = 6.0  # of the criterion, else indistinguishable (Kass and Raftery 1995)
    separation_general: float = 3.0  # the same for a generalisation of the best: 1 % by chance
    compared: float = 40.0  # the same on shorter windows, above which longer ones are not compared
    clearly: float = 50.0  # of the criterion, more than longer windows change a comparison by
    overwhelming: float = 500.0  # the same, more than the error of a fit that has not converged
    diverged: float = 10.0  # chi2 a sample, of whole runs that diverged
    nuisance_limit: float = 1.8  # prior standard deviations of a derivative: beyond, an effect replaces it
    most_rivals: int = 4  # that are listed
    stages_tested: int = 3  # window lengths on which a cause may be confirmed (Bonferroni)
    # ---- Beam search
    step_budget: float = 3e7  # steps of a boat, about fifteen seconds, after which no depth is begun
    most_effects: int = 3  # together, the hull's derivatives counted as one
    beam: int = 5  # sets that are expanded
    shortlist: int = 8  # sets that are fitted at each depth
    always_fitted: int = 3  # of them, unless the residual of one is noise
    followed: int = 4  # of them, those that are fitted to longer windows
    least_information: float = 10.0  # squared typical size over variance: a standard error of a third of it
    jump_part: int = 4  # windows of which one is fitted first for an effect without parameters
    jump_windows: int = 12  # windows in all, from which that is done
    follow_share: float = 0.2  # of the best gain by which another may be worse and still be followed
    follow_share_far: float = 0.5  # where longer windows of the best need more; of its gain on whole runs
    follow_beam: float = 200.0  # chi2 by which it may be worse in any case
    follow_adequate: float = 100.0  # the same where the best is adequate
    follow_inadequate: float = 0.5  # of the best criterion, in addition, where it is not
    follow_fit: float = 300.0  # chi2 expected above the best fitted, up to which a set is fitted
    # ---- Exchange search
    exchange_fits: int = 2  # sets that are fitted in place of each effect
    exchange_budget: float = 12e6  # boat steps, about ten seconds, after which no further round is begun
    exchange_hopeless: float = 30.0  # chi2 a sample of the middle windows, above which none is tried
    exchange_reach: float = 0.5  # typical sizes to either side of its values that an effect begins again from
    # ---- Reconstruction of commands between samples
    common_share_step: float = 0.5  # of a share of all commands, of the finite difference
    common_share_rounds: int = 3  # Gauss-Newton steps in it
    reconstruction_gain: float = 40.0  # chi2 that a reconstruction must save
    reconstruction_share: float = 0.2  # of chi2 above noise, also: commands do not explain a missing force
    reconstruction_most: float = 3.0  # chi2 a sample above which none is accepted
    reconstruction_hopeless: float = 30.0  # chi2 a sample above which none is tried
    instants_damping: tuple[float, float, int] = (0.1, 10.0, 5)  # of the information: least, factor, tries
    reconstruction_rounds: int = 8  # repetitions of the fit of all switching times
    instants_reach: float = 2.0  # times the gain that normal equations promise: the most that a fit may have
    # ---- Continuation in the window length
    window_lengths: tuple[float, float] = (5.0, 20.0)  # s, at least: nearly convex, discriminating
    window_lengths_of_boat: tuple[float, float] = (5.5, 22.0)  # L/U of the boat, at least
    stage_steps: tuple[int, ...] = (8, 10, 10, 10)  # Jacobians of a fit, by stage
    first_rounds: int = 12  # iterations of the first initial states
    steps_when_close: int = 16  # Jacobians of a fit whose shorter windows fit well
    most_corrections: int = 4  # repetitions of the search for unlogged commands
    far_from_data: float = 10.0  # chi2 a sample of a fit that is far from the data
    converged_share: float = 0.25  # of the expected fall of chi2, below which such a fit has not converged
    restart_share: float = 0.5  # of the shortest window, length of those that a fit is restarted from
    # ---- Frequency scan
    wave_piece: float = 0.5  # s of constant force
    lowest_wave: float = 0.0358  # U/L (0.04 Hz of SWAMP)
    highest_wave: float = 0.895  # U/L (1 Hz of SWAMP)
    # numbers (about 4 s) in the Jacobian of a scan of whole runs, where the middle windows, which show most
    # waves, leave noise: it grows with the square of the runs' length
    largest_scan: float = 2e8
    # intervals of a window up to which the information of pulses costs less than every frequency's response
    wave_pulses: int = 100
    wave_fineness: float = 4.0  # frequencies for each 1 / (length of the longest run)
    wave_peaks: int = 2  # that a fit is begun from
    wave_sampling: float = 0.3  # cycles a sample, at most
    peak_reach: int = 3  # frequencies to either side that a peak exceeds
    # ---- Information criterion
    posterior_sd: float = 0.01  # of a coefficient's scale that has a prior, from rich runs of some minutes
    # ---- Noise under which the selection is made
    model_error_chi2: float = 3.0  # chi2 a sample from which the model error dominates
    wander_rounds: int = 3  # repetitions of fit and noise estimate
    step_budget_again: float = 5e6  # boat steps of each later search
    noise_unchanged: tuple[float, float] = (1.0, 1.5)  # in log size and log time: steps of the grid
    most_repeats: int = 3  # searches under re-estimated noise
    total_budget: float = 2e7  # boat steps of all searches, after which none is repeated
    most_reconstructions: int = 2  # searches with reconstructed commands
    # ---- Score test
    instants: int = 17  # of a failure, evaluated about the best one
    grid_batch: int = 24  # grid points in one simulation
    large_chi2: float = 2.0  # chi2 a sample, above which states are refitted for an effect without parameters
    score_rounds: int = 3  # iterations of that
    neutral_step: float = 1e-3  # typical sizes beside a neutral value at which a derivative does not exist
    # ---- Effects too small for short windows
    small_shortlist: int = 5  # candidates that are fitted for each effect
    not_converged: float = 8.0  # chi2 by which another start must be better than a fit
    # ---- Stepwise selection under model error
    most_exchanges: int = 3  # single effects tried in place of each effect at the end
    screening_samples: int = 8000  # of score tests
    curve_errors_level: float = 1e-2  # of any false alarm by the ratio tests beside errors of the curves
    # ---- Share of the prediction error
    judged_horizons: tuple[float, ...] = (10.0, 30.0)  # s that causes are judged at
    trivial_from: float = 5.0  # s, below which all that start from the measured state predict well
    minor: float = 0.02  # of the error without the cause: less is minor, if below the sensor's noise too
    # ---- Estimates
    at_bound: float = 1e-3  # of a parameter's typical size: its distance from a bound that it is at
    # ---- Functions of the missing force
    curve_tails: float = 0.001  # of a noisy channel's samples to each side, which may be outliers
    curve_wider: float = 0.25  # of the last interval, by which knots reach beyond an unmeasured variable's
    knot_share: float = 0.01  # of the samples about an angle's knot, below which its value is zero
    round_angle: float = 1e-3  # rad by which knots that go round an angle may be unevenly spaced
    curve_scale: float = 0.1  # of the boat's thrust: standard deviation of the prior of the values
    curve_bound: float = 1e3  # typical sizes
    formula_grid: int = 25  # thresholds that a formula's fit may start from
    formula_reach: float = 0.95  # of the range, the largest of them
    threshold_scale: float = 0.1  # of the range, typical size of a threshold
    jump_step: float = 0.02  # of the range: finite difference of a threshold at which the force jumps
    # ---- The missing force as an effect
    most_functions: int = 2  # together; one of both position coordinates counts as one
    knot_rounds: int = 3  # of moving knots into the interval in which a function changes most
    # ---- Regression of the residual force
    # s of a window and of a coarse interval of constant force, fine intervals in it
    regression_spans: tuple[float, float, int] = (10.0, 2.5, 4)
    # the same where velocities were not measured
    regression_spans_poses: tuple[float, float, int] = (10.0, 5.0, 5)
    # sizes of the forces about which is linearised, in `force_scale`: larger ones follow a receiver's jumps
    regression_reach: tuple[float, ...] = (0.1, 0.1, 0.01)
    regression_windows: int = 240  # evaluated; of more, evenly spaced ones
    knots: int = 6  # of a function of a variable
    knots_of_angle: int = 8  # of a function of an angle: 45 degrees apart
    regression_priors: tuple[float, ...] = (0.0205, 0.102, 0.512)  # thrusts, of the weights; the best counts
    folds: int = 8  # at most
    regression_time: float = 4.0  # s, correlation time of the process noise
    regression_gain: float = 15.0  # chi2 on held-out folds that a further pair must save
    regression_tie: float = 0.7  # share of the first one's gain from which another is listed with it
    listed_functions: int = 4  # functions of the residual force
    knot_tail: float = 0.02  # of the samples beyond the first and the last knot
    knots_apart: float = 1e-3  # of the range, at least
    # ---- Residual force
    force_spans: tuple[float, float] = (5.0, 2.5)  # s of a window and of constant force in it
    force_spans_poses: tuple[float, float] = (10.0, 5.0)  # the same where velocities were not measured
    force_measured: float = 0.25  # of the positions in an interval, below which its force is not estimated
    force_rounds: int = 30  # iterations, at most
    force_damping: float = 0.1  # the first after a step that fails
    force_reach: tuple[float, ...] = (1.5, 1.5, 1.5)  # sizes of the forces' prior, in `force_scale`
    # ---- Self-trial
    twins: int = 20  # simulated from an answer
    twin_out_of_reach: float = 100.0  # criterion above the best of a hypothesis that is left out
    twin_within_reach: float = 40.0  # the same of an expected criterion, which a fit only lowers
    twin_fits: int = 6  # score tests beside a simpler hypothesis whose hypotheses are fitted
    # ---- The next trial
    trial_seconds: float = 60.0  # s
    trial_durations: tuple[float, float] = (20.0, 600.0)  # s, shortest and longest
    trial_beyond: float = 2.0  # s by which it exceeds the shortest run of a diagnosis
    area_margin_lengths: float = 1.0  # boat lengths to the border of the area
    area_margin_side: float = 0.1  # of the shorter side, to the border
    least_area: float = 2.0  # boat lengths that remain for the tracks
    least_trial_evidence: float = 0.01  # below which a trial decides nothing
    trial_random: int = 32  # random sequences at first
    trial_parents: int = 4  # sequences kept of a round
    trial_children: int = 24  # sequences tried in a round
    trial_budget: int = 16_000_000  # boat steps of a design, about 15 s of a processor
    trial_patience: int = 15  # rounds in a row with little gain, which end the search
    trial_worth: float = 0.01  # share that counts as a gain
    trial_hold: float = 2.0  # s, the shortest time that a command is held
    trial_block: int = 6  # commands that an exchange replaces, at most
    trial_levels: tuple[float, ...] = (0.0, 0.3, 0.6, 0.8, 1.0)  # of the greatest throttle
    trial_angle_step: float = math.pi / 6  # rad between azimuths that are tried
    trial_starts: tuple[float, ...] = (0.0, 1.0, 2.0, 4.0)  # linearised steps to begin a refit at
    trial_whole_boat: float = 0.6  # share of the exchanges that command all thrusters
    # ---- Candidates in the report
    listed: int = 20  # hypotheses that were fitted
    # ---- Printed figures
    figures_level: float = 0.95  # of chi2, below which a model is adequate
    least_change: float = 0.01  # errors by which a candidate must change some figure to be identifiable
    figure_starts: int = 2  # of a fit
    figure_sets: int = 4  # sets that are extended by a further effect
    figure_effects: int = 3  # effects in a stage
    figure_evaluations: int = 30  # of a fit
    figure_tolerance: float = 1e-5  # of chi2 and of the parameters, relative: less change ends a fit
    figure_step: float = 1e-4  # of a number, finite difference
    figure_far: float = 1e4  # errors: misfit of a figure that a boat cannot give
    figures_listed: int = 15  # candidates
    # ---- Posterior
    posterior_reach: float = 5.0  # standard errors to either side beyond which nothing is drawn


DEFAULT = Options()
_IN_FORCE: ContextVar[Options] = ContextVar("options", default=DEFAULT)


def options() -> Options:
    """The options in force."""
    return _IN_FORCE.get()


@contextmanager
def using(**changes: object) -> Iterator[Options]:
    """Put the options in force with these fields changed, inside a `with` block."""
    token = _IN_FORCE.set(replace(options(), **changes))  # type: ignore[arg-type]
    try:
        yield options()
    finally:
        _IN_FORCE.reset(token)
