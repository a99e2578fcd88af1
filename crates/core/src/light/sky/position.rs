//! Position of the sun: Blanco-Muriel, Alarcón-Padilla, López-Moratalla, Lara-Coira, "Computing the solar vector",
//! Solar Energy 70 (2001), which is within half a minute of arc in the years 1999 to 2015.

use glam::DVec3;

/// A place on Earth and a moment there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// North of the equator, in degrees.
    pub latitude: f64,
    /// East of Greenwich, in degrees.
    pub longitude: f64,
    /// Offset of local time from universal time, in hours; positive if ahead.
    pub timezone: f64,
    /// Year, month and day of the Gregorian calendar; months and days from one.
    pub date: [i64; 3],
    /// Local time in hours.
    pub hours: f64,
}

impl Moment {
    /// Days since noon of 1 January 2000, universal time.
    fn days(&self) -> f64 {
        let [year, month, day] = self.date;
        // Fliegel, Van Flandern, "A machine algorithm for processing calendar dates", CACM 11 (1968).
        let early = (month - 14) / 12;
        let julian = (1461 * (year + 4800 + early)) / 4 + (367 * (month - 2 - 12 * early)) / 12
            - (3 * ((year + 4900 + early) / 100)) / 4
            + day
            - 32075;
        julian as f64 - 0.5 + self.universal_hours() / 24.0 - 2_451_545.0
    }

    fn universal_hours(&self) -> f64 {
        self.hours - self.timezone
    }

    /// The unit vector to the sun: +x is north, +y west, +z up.
    pub fn sun(&self) -> DVec3 {
        // Ecliptic coordinates of the sun from the days since the epoch.
        let n = self.days();
        let node = 2.1429 - 0.001_039_459_4 * n;
        let anomaly = 6.240_060_0 + 0.017_201_969_9 * n;
        let longitude =
            4.895_063_0 + 0.017_202_791_698 * n + 0.033_416_07 * anomaly.sin() + 0.000_348_94 * (2.0 * anomaly).sin()
                - 0.000_113_4
                - 0.000_020_3 * node.sin();
        let obliquity = 0.409_092_8 - 6.2140e-9 * n + 0.000_039_6 * node.cos();
        // Equatorial: along the equinox, 90° east of it, and the pole.
        let (sin_l, cos_l) = longitude.sin_cos();
        let equatorial = DVec3::new(cos_l, obliquity.cos() * sin_l, obliquity.sin() * sin_l);
        // Local mean sidereal time, in degrees.
        let sidereal = (6.697_424_324_2 + 0.065_709_828_3 * n + self.universal_hours()) * 15.0 + self.longitude;
        let (sin_s, cos_s) = sidereal.to_radians().sin_cos();
        // Along the meridian, and east.
        let meridian = cos_s * equatorial.x + sin_s * equatorial.y;
        let east = -sin_s * equatorial.x + cos_s * equatorial.y;
        // Rotate from the equator to the horizon of the place.
        let (sin_b, cos_b) = self.latitude.to_radians().sin_cos();
        let up = cos_b * meridian + sin_b * equatorial.z;
        let north = cos_b * equatorial.z - sin_b * meridian;
        // Parallax: seen from the surface, the zenith angle is greater by the Earth's radius over the distance times
        // its sine.
        const PARALLAX: f64 = 6371.01 / 149_597_890.0;
        DVec3::new(north, -east, up - PARALLAX).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Height and azimuth from north by east, in degrees.
    fn angles(m: &Moment) -> (f64, f64) {
        let d = m.sun();
        (d.z.asin().to_degrees(), (-d.y).atan2(d.x).to_degrees().rem_euclid(360.0))
    }

    /// The example of Reda and Andreas, "Solar position algorithm for solar radiation applications"
    /// (NREL/TP-560-34302), table A5.1: Golden, 17 October 2003, 12:30:30 at UTC−7: zenith angle 50.11162° with
    /// refraction of 0.016°, azimuth 194.34024°.
    #[test]
    fn the_published_example() {
        let m = Moment {
            latitude: 39.742_476,
            longitude: -105.1786,
            timezone: -7.0,
            date: [2003, 10, 17],
            hours: 12.0 + 30.5 / 60.0,
        };
        let (height, azimuth) = angles(&m);
        assert!((height - (90.0 - 50.111_62 - 0.0163)).abs() < 0.01, "{height}");
        assert!((azimuth - 194.340_24).abs() < 0.01, "{azimuth}");
    }

    /// At the solstices and equinoxes of 2010 (US Naval Observatory: 20 March 17:32, 21 June 11:28, 23 September 03:09,
    /// 21 December 23:38, universal time) the declination is ±23.438° or zero: so is the height at the pole.
    #[test]
    fn seasons() {
        for (date, hours, declination) in [
            ([2010, 3, 20], 17.0 + 32.0 / 60.0, 0.0),
            ([2010, 6, 21], 11.0 + 28.0 / 60.0, 23.438),
            ([2010, 9, 23], 3.0 + 9.0 / 60.0, 0.0),
            ([2010, 12, 21], 23.0 + 38.0 / 60.0, -23.438),
        ] {
            let m = Moment { latitude: 90.0, longitude: 0.0, timezone: 0.0, date, hours };
            let (height, _) = angles(&m);
            assert!((height - declination).abs() < 0.01, "{date:?}: {height}");
        }
    }

    /// The sun rises in the east, is in the south at noon of the northern half, and sets in the west; time zones move
    /// clocks alone.
    #[test]
    fn a_day() {
        let at = |hours, timezone| Moment { latitude: 45.0, longitude: 15.0, timezone, date: [2010, 6, 21], hours };
        assert!(at(6.0, 1.0).sun().y < -0.8 && at(18.0, 1.0).sun().y > 0.8);
        let (height, azimuth) = angles(&at(12.0 + 1.8 / 60.0, 1.0));
        assert!((height - (45.0 + 23.438)).abs() < 0.01 && (azimuth - 180.0).abs() < 0.3, "{height} {azimuth}");
        assert!((at(7.0, 1.0).sun() - at(9.0, 3.0).sun()).length() < 1e-12);
    }
}
