//! Values by station, by prism, or by pair of prisms.

use std::marker::PhantomData;
use std::ops::{Index, IndexMut};

use serde::{Deserialize, Serialize};

use super::number::{Number, Pair, Prism, Station, StationPair};

/// One value for each number, in the order of the numbers.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(transparent, bound(serialize = "T: Serialize", deserialize = "T: Deserialize<'de>"))]
pub struct Per<N, T> {
    values: Vec<T>,
    #[serde(skip)]
    number: PhantomData<fn(N) -> N>,
}

/// One value for each station.
pub type PerStation<T> = Per<Station, T>;
/// One value for each prism.
pub type PerPrism<T> = Per<Prism, T>;
/// One value for each pair of prisms.
pub type PerPair<T> = Per<Pair, T>;
/// One value for each pair of stations.
pub type PerStationPair<T> = Per<StationPair, T>;

impl<N: Number, T> Per<N, T> {
    /// Returns the value of each of `count` numbers.
    pub fn from_fn(count: usize, value: impl FnMut(N) -> T) -> Self {
        (0..count).map(N::at).map(value).collect()
    }

    /// Returns the same value `count` times.
    pub fn repeat(count: usize, value: T) -> Self
    where
        T: Clone,
    {
        std::iter::repeat_n(value, count).collect()
    }

    pub fn len(&self) -> usize {
        self.values.len()
    }

    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Returns the numbers, the first one first.
    pub fn numbers(&self) -> impl DoubleEndedIterator<Item = N> + ExactSizeIterator + use<N, T> {
        (0..self.len()).map(N::at)
    }

    /// Returns the value of a number; `None` beyond the last.
    pub fn get(&self, number: N) -> Option<&T> {
        self.values.get(number.index())
    }

    pub fn iter(&self) -> std::slice::Iter<'_, T> {
        self.values.iter()
    }

    pub fn iter_mut(&mut self) -> std::slice::IterMut<'_, T> {
        self.values.iter_mut()
    }

    /// Returns each number with its value.
    pub fn each(&self) -> impl DoubleEndedIterator<Item = (N, &T)> + ExactSizeIterator {
        self.numbers().zip(&self.values)
    }

    pub fn as_slice(&self) -> &[T] {
        &self.values
    }

    pub fn as_mut_slice(&mut self) -> &mut [T] {
        &mut self.values
    }

    /// Returns a value for each value.
    pub fn map<U>(&self, value: impl FnMut(&T) -> U) -> Per<N, U> {
        self.iter().map(value).collect()
    }

    /// Returns a value for each number and its value.
    pub fn map_each<U>(&self, mut value: impl FnMut(N, &T) -> U) -> Per<N, U> {
        self.each().map(|(number, own)| value(number, own)).collect()
    }

    /// Returns a value for each two values of the same number.
    pub fn zip<U, V>(&self, other: &Per<N, U>, mut value: impl FnMut(&T, &U) -> V) -> Per<N, V> {
        self.iter().zip(other).map(|(own, other)| value(own, other)).collect()
    }

    /// Returns the values as an array of a fixed size; `None` if there are more or fewer.
    pub fn as_array<const COUNT: usize>(&self) -> Option<&[T; COUNT]> {
        self.as_slice().try_into().ok()
    }

    /// Returns the values as an array of a fixed size; `None` if there are more or fewer.
    pub fn into_array<const COUNT: usize>(self) -> Option<[T; COUNT]> {
        self.values.try_into().ok()
    }

    pub fn push(&mut self, value: T) {
        self.values.push(value);
    }

    /// Shortens the list, or adds values at its end.
    pub fn resize_with(&mut self, count: usize, value: impl FnMut() -> T) {
        self.values.resize_with(count, value);
    }
}

impl Prism {
    /// Returns the number of prisms among which the stations' prisms are.
    pub fn count(followed: &PerStation<Self>) -> usize {
        followed.iter().map(|prism| prism.number()).max().unwrap_or(0)
    }

    /// Returns true if all stations follow one prism.
    pub fn is_one(followed: &PerStation<Self>) -> bool {
        Self::count(followed) == 1
    }
}

impl<N, T> Default for Per<N, T> {
    fn default() -> Self {
        Self { values: Vec::new(), number: PhantomData }
    }
}

impl<N, T> FromIterator<T> for Per<N, T> {
    fn from_iter<I: IntoIterator<Item = T>>(values: I) -> Self {
        Self { values: values.into_iter().collect(), number: PhantomData }
    }
}

impl<N, T, const COUNT: usize> From<[T; COUNT]> for Per<N, T> {
    fn from(values: [T; COUNT]) -> Self {
        values.into_iter().collect()
    }
}

impl<N: Number, T> Index<N> for Per<N, T> {
    type Output = T;

    fn index(&self, number: N) -> &T {
        &self.values[number.index()]
    }
}

impl<N: Number, T> IndexMut<N> for Per<N, T> {
    fn index_mut(&mut self, number: N) -> &mut T {
        &mut self.values[number.index()]
    }
}

/// By place, for code that counts stations, prisms and pairs in `usize`.
impl<N, T> Index<usize> for Per<N, T> {
    type Output = T;

    fn index(&self, index: usize) -> &T {
        &self.values[index]
    }
}

impl<N, T> IndexMut<usize> for Per<N, T> {
    fn index_mut(&mut self, index: usize) -> &mut T {
        &mut self.values[index]
    }
}

impl<N, T> IntoIterator for Per<N, T> {
    type Item = T;
    type IntoIter = std::vec::IntoIter<T>;

    fn into_iter(self) -> Self::IntoIter {
        self.values.into_iter()
    }
}

impl<'a, N, T> IntoIterator for &'a Per<N, T> {
    type Item = &'a T;
    type IntoIter = std::slice::Iter<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.values.iter()
    }
}

impl<'a, N, T> IntoIterator for &'a mut Per<N, T> {
    type Item = &'a mut T;
    type IntoIter = std::slice::IterMut<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.values.iter_mut()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_have_the_numbers_of_their_stations() {
        let names: PerStation<String> = Per::from_fn(4, |station: Station| format!("S{station}"));
        assert_eq!(names.as_slice(), ["S1", "S2", "S3", "S4"]);
        let last = names.numbers().next_back().expect("a station");
        assert_eq!((&*names[last], last.number()), ("S4", 4));
        let lengths = names.zip(&names.map(String::len), |name, length| name.len() == *length);
        assert!(lengths.iter().all(|is_equal| *is_equal));
        assert_eq!(names.as_array::<3>(), None);
    }

    #[test]
    fn values_are_a_list_in_files() {
        let ranges_m: PerPair<f64> = Per::from([1.0, 2.5]);
        let json = serde_json::to_string(&ranges_m).expect("JSON");
        assert_eq!(json, "[1.0,2.5]");
        assert_eq!(serde_json::from_str::<PerPair<f64>>(&json).expect("a list"), ranges_m);
    }
}
