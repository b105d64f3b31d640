//! The number of stations of a deployment, from everything that states it.

use crate::error::OpenError;
use crate::findings::readings::station_without_readings;
use resect_core::deployment::{
    ControlPoint, Deployment, FollowedPrisms, Overrides, PrismConstants, StatedPrismChange, Track,
    as_numbered,
};
use resect_core::network::{
    MOST_STATIONS, Number, Pair, PerStation, Prism, Station, USUAL_STATIONS,
};

/// Adds the stations without readings that control points, rig or `deployment.toml` state, and gives each station its prism.
///
/// `files` names the source of the tracks.
pub fn complete_stations(deployment: &mut Deployment, files: &str) -> Result<(), OpenError> {
    let overrides = deployment.overrides.clone();
    let with_tracks = deployment.tracks.len();
    check_lengths(&overrides, with_tracks)?;
    let with_points = |deployment: &Deployment| {
        let points = deployment.control_points.iter().flat_map(|set| &set.points);
        points.map(ControlPoint::stations).max().unwrap_or_default()
    };
    let numbers = overrides.stations.as_ref();
    if let Some(chosen) = numbers.and_then(|numbers| chosen(numbers, with_points(deployment))) {
        for point in deployment.control_points.iter_mut().flat_map(|set| &mut set.points) {
            point.choose(&chosen);
        }
    }
    let with_points = with_points(deployment);
    // Who lists the stations leaves out the others: their control points and prisms remain without effect.
    let listed = overrides.stations.as_ref().map(PerStation::len);
    let listed = listed.or_else(|| overrides.topics.as_ref().map(PerStation::len));
    let further = || with_points.max(stated_by_prisms(deployment, &overrides)).min(MOST_STATIONS);
    let stations = with_tracks.max(listed.unwrap_or_else(further));

    let constants = overrides.prism_constant_m.clone().unwrap_or_default();
    let include_constant = overrides.ranges_include_prism_constant == Some(true);
    let has_readings = deployment.tracks.iter().any(|track| !track.measurements.is_empty());
    while deployment.tracks.len() < stations {
        let station = deployment.tracks.len();
        if has_readings {
            let others = deployment.numbers_with_readings();
            deployment.findings.push(station_without_readings(station, files, &others));
        }
        let constants_m = constants.each_m(station + 1);
        let prism_constant_m = if include_constant { 0.0 } else { constants_m[station] };
        deployment.tracks.push(Track { prism_constant_m, ..Track::default() });
    }
    deployment.time_corrections.resize_with(stations, Vec::new);
    for point in deployment.control_points.iter_mut().flat_map(|set| &mut set.points) {
        point.resize(stations);
    }
    let with_prisms =
        deployment.rig.as_ref().and_then(|rig| Pair::prisms_of(rig.inter_prism_m.len()));
    let own_prisms = numbers.and_then(|numbers| chosen(numbers, with_prisms?));
    let prism_of = |station: Station| match (&overrides.prisms, &own_prisms) {
        (Some(prisms), _) => prisms.of_station(station),
        (None, Some(chosen)) => Some(Prism::at(chosen.get(station)?.index())),
        (None, None) => None,
    };
    for (place, track) in deployment.tracks.iter_mut().enumerate() {
        let station = Station::numbered(place + 1);
        track.prism = station.and_then(prism_of);
        let stated = overrides.prism_changes.iter().flatten();
        let changes = stated.filter_map(StatedPrismChange::change);
        let changes = changes.filter(|(other, _)| Some(*other) == station);
        track.prism_changes = changes.map(|(_, change)| change).collect();
        track.prism_changes.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    }
    if stations != USUAL_STATIONS && deployment.as_read.stations.is_none() {
        deployment.as_read.stations = Some(as_numbered(stations));
    }
    Ok(())
}

/// Returns the stations that a list of numbers chooses among some that are numbered from 1; `None` if it only says in which order they are,
/// or has numbers of its own.
fn chosen(numbers: &PerStation<i64>, among: usize) -> Option<PerStation<Station>> {
    let station = |number: &i64| Station::numbered(usize::try_from(*number).ok()?);
    let chosen: PerStation<Station> = numbers.iter().map(station).collect::<Option<_>>()?;
    let is_known = |station: &Station| station.index() < among;
    let is_order = chosen.iter().all(|station| station.index() < chosen.len());
    (!is_order && chosen.iter().all(is_known)).then_some(chosen)
}

/// Returns the number of stations that `deployment.toml` or the user lists.
pub fn listed_stations(overrides: &Overrides) -> Option<usize> {
    let prisms = match &overrides.prisms {
        Some(FollowedPrisms::Each(prisms)) => Some(prisms.len()),
        _ => None,
    };
    let numbers = overrides.stations.as_ref().map(PerStation::len);
    numbers.or_else(|| overrides.topics.as_ref().map(PerStation::len)).or(prisms)
}

/// Returns the number of stations that the prisms show: each station follows its own unless `prisms` says otherwise.
fn stated_by_prisms(deployment: &Deployment, overrides: &Overrides) -> usize {
    match (&overrides.prisms, &deployment.rig) {
        (Some(FollowedPrisms::Each(prisms)), _) => prisms.len(),
        (Some(FollowedPrisms::Count(1)), _) | (None, None) => 0,
        (Some(FollowedPrisms::Count(prisms)), _) => usize::from(*prisms),
        (None, Some(rig)) => Pair::prisms_of(rig.inter_prism_m.len()).unwrap_or_default(),
    }
}

/// Checks that no list of values by station is shorter than the number of tracks.
fn check_lengths(overrides: &Overrides, stations: usize) -> Result<(), OpenError> {
    let prisms = match &overrides.prisms {
        Some(FollowedPrisms::Each(prisms)) => Some(prisms.len()),
        Some(FollowedPrisms::Count(prisms)) if (2..stations).contains(&usize::from(*prisms)) => {
            return Err(OpenError::file(
                "deployment.toml",
                format!("prisms is {prisms}, but there are {stations} stations"),
                "list the prism of each station: prisms = [1, 2, 2]",
            ));
        }
        _ => None,
    };
    let changes = overrides.prism_changes.iter().flatten();
    let beyond = changes.map(|change| usize::from(change.station)).max();
    if let Some(station) = beyond.filter(|station| *station > stations) {
        return Err(OpenError::file(
            "deployment.toml",
            format!("prism_changes names station {station}, but there are {stations} stations"),
            "stations are numbered from 1, in the order of stations",
        ));
    }
    let constants = match &overrides.prism_constant_m {
        Some(PrismConstants::Each(constants_m)) => Some(constants_m.len()),
        _ => None,
    };
    for (key, length) in [("prisms", prisms), ("prism_constant_m", constants)] {
        if let Some(length) = length.filter(|length| *length < stations) {
            return Err(OpenError::file(
                "deployment.toml",
                format!("{key} lists {length} values, but there are {stations} stations"),
                "give one value for each station",
            ));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::open::open_files;
    use resect_core::network::Number;

    /// Returns a table with ten readings of each station.
    fn readings(stations: usize) -> String {
        let row = |i: usize| format!("{}.0,{},10,0.1,1.5\n", i / stations, i % stations + 1);
        "timestamp,id,distance,ha,va\n".to_owned()
            + &(0..10 * stations).map(row).collect::<String>()
    }

    #[test]
    fn the_prism_of_each_station_is_stated_by_a_number_or_a_list() {
        let prisms = |stations: usize, toml: &str| {
            let files = [("t.csv", &*readings(stations)), ("deployment.toml", toml)];
            let deployment = open_files("d", &files).map_err(|error| error.to_string())?;
            let prism_of = |track: &resect_core::deployment::Track| track.prism.map(Number::index);
            Ok::<_, String>(deployment.tracks.iter().map(prism_of).collect::<Vec<_>>())
        };
        assert_eq!(prisms(4, ""), Ok(vec![None; 4]));
        assert_eq!(prisms(4, "prisms = 1"), Ok(vec![Some(0); 4]));
        assert_eq!(prisms(3, "prisms = 3"), Ok(vec![Some(0), Some(1), Some(2)]));
        assert_eq!(prisms(3, "prisms = [1, 2, 2]"), Ok(vec![Some(0), Some(1), Some(1)]));
        // A station without readings.
        assert_eq!(prisms(2, "prisms = [1, 2, 1]"), Ok(vec![Some(0), Some(1), Some(0)]));
        let error = prisms(4, "prisms = 2").expect_err("ambiguous");
        assert!(error.contains("list the prism of each station"), "{error}");
        let error = prisms(4, "prisms = [1, 2, 2]").expect_err("short");
        assert!(error.contains("prisms lists 3 values, but there are 4 stations"), "{error}");
        let error = prisms(3, "prisms = 0").expect_err("none");
        assert!(error.contains("prisms is 0"), "{error}");
    }
}
