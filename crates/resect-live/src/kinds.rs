//! Kinds of findings of a live deployment.

resect_core::finding_kinds! {
    /// The live source is not connected.
    LIVE_NO_CONNECTION = "no-connection", Warning;
    /// A station has had no reading for a while.
    LIVE_LOST_LOCK = "lost-lock", Warning;
    /// The clock of a station jumped during the live drive.
    LIVE_CLOCK_JUMPED = "clock-jumped", Warning, CLOCK;
    /// A station or its clock stepped during the live drive.
    LIVE_STEPPED = "stepped", Warning, STATION_MOVED;
    /// A station follows the prism of another.
    LIVE_WRONG_PRISM = "wrong-prism", Warning, DISTANCES;
    /// The live drive is a straight line so far.
    LIVE_STRAIGHT_LINE = "straight-line", Warning;
    /// The live drive has no inter-prism distances.
    LIVE_NO_RIG = "no-rig", Warning, RIG;
    /// Topics or instruments of the live source belong to no station.
    LIVE_NO_STATION = "no-station", Warning;
    /// The live drive is no longer recorded.
    LIVE_NOT_RECORDED = "not-recorded", Warning;
}
