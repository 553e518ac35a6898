//! Writers of the formats of agencies, after the layout of real files; the values are made up.

use std::fmt::Write as _;

/// One channel of a file.
#[derive(Clone)]
pub(super) struct Motion {
    pub(super) component: &'static str,
    /// Samples in the unit of the file.
    pub(super) samples: Vec<f64>,
    /// Step (s).
    pub(super) step: f64,
}

impl Motion {
    /// A motion of this many samples and this peak, rounded to some decimals.
    pub(super) fn new(
        component: &'static str,
        count: usize,
        step: f64,
        peak: f64,
        decimals: i32,
    ) -> Self {
        let scale = 10f64.powi(decimals);
        let shape = |i: usize| (0.71 * i as f64).sin() * (i as f64 / count as f64);
        let samples = (0..count).map(|i| (peak * shape(i) * scale).round() / scale);
        Self {
            component,
            samples: samples.collect(),
            step,
        }
    }
    pub(super) fn peak(&self) -> f64 {
        self.samples
            .iter()
            .copied()
            .reduce(|a, b| if b.abs() > a.abs() { b } else { a })
            .unwrap()
    }
    fn duration(&self) -> f64 {
        self.samples.len() as f64 * self.step
    }
}

/// Numbers in rows of this many, each written by `write`.
fn rows(samples: &[f64], each: usize, write: impl Fn(f64) -> String) -> String {
    let row = |row: &[f64]| row.iter().map(|a| write(*a)).collect::<String>() + "\n";
    samples.chunks(each).map(row).collect()
}

/// A number of Fortran without the zero before the point.
fn bare(value: f64, width: usize, decimals: usize) -> String {
    let text = format!("{value:.decimals$}").replacen("0.", ".", usize::from(value.abs() < 1.0));
    format!("{text:>width$}")
}

/// Counts of K-NET (or KiK-net, whose header numbers the sensors), with an offset; `year` changes what later years changed.
pub(super) fn knet(motion: &Motion, year: u32, offset: f64) -> String {
    let (gals, counts) = if year < 2000 {
        (2000.0, 8_388_608.0)
    } else {
        (7845.0, 8_223_790.0)
    };
    let raw: Vec<f64> = motion
        .samples
        .iter()
        .map(|a| ((a + offset) * counts / gals).round())
        .collect();
    let mean = raw.iter().sum::<f64>() / raw.len() as f64;
    let peak = raw
        .iter()
        .fold(0.0_f64, |most, a| most.max((a - mean).abs()))
        * gals
        / counts;
    let mut text = format!(
        "Origin Time       {year}/12/31 23:49:00\nLat.              35.785\nLong.             139.887\n\
         Depth. (km)       84\nMag.              4.2\nStation Code      CHB002\n\
         Station Lat.      35.7868\nStation Long.     139.9031\nStation Height(m) 14\n\
         Record Time       {year}/12/31 23:50:00\nSampling Freq(Hz) {}Hz\nDuration Time(s)  {}\n\
         Dir.              {}\nScale Factor      {gals}(gal)/{counts}\nMax. Acc. (gal)   {peak:.3}\n\
         Last Correction   {year}/12/31 23:49:59\nMemo.             \n",
        1.0 / motion.step,
        motion.duration().round(),
        match motion.component {
            "EW2 (surface)" => "5",
            "UD1 (borehole)" => "3",
            other => other,
        },
    );
    text += &rows(&raw, 8, |a| format!("{a:>8} "));
    text
}

/// A data set of COSMOS v1.20: acceleration, with velocity behind it if `with_others` is true.
pub(super) fn cosmos(motions: &[Motion], format: &str, with_others: bool) -> String {
    let mut text = String::new();
    for (at, motion) in motions.iter().enumerate() {
        for quantity in ["acceleration", "velocity"] {
            if quantity == "velocity" && !with_others {
                continue;
            }
            let unit = if quantity == "velocity" {
                "cm/sec(05)"
            } else {
                "cm/sec2(04)"
            };
            let mut reals = vec![-999.0; 100];
            reals[33] = 0.02;
            reals[61] = 1000.0 * motion.step;
            reals[62] = motion.duration();
            reals[63] = motion.peak();
            let count = motion.samples.len();
            let _ = write!(
                text,
                "Corrected {quantity}    (Format v01.20 with 13 text lines)\n\
                 Record of Point MacKenzie Earthquake of Fri Nov 30, 2018 17:29 UTC\n\
                 Hypocenter: 61.34640 -149.95520 H= 46km Mw=7.0\n\
                 Origin: 2018/11/30 17:29:29    UTC\n\
                 Statn No: 37-000011 Code:AK-BMR     UAF  Bremner River, AK, USA\n\
                 Coords: 60.9677 -144.6051  Site geology:\nRecorder: (see cmnt)\n\
                 Rcrd start time: 2018/11/30 17:29:39.137 UTC (Q=5) RcrdId: (see comment)\n\
                 Sta Chan   {}:{} (Rcrdr Chan  ?) Location:\nRaw record length = 210.000 sec\n\
                 Processed:2019-03-03\nRecord filtered below  0.03 Hz\n\
                 Values used when parameter or data value is unknown/unspecified:   -999, -999.00\n \
                 100 Integer-header values follow on  10 lines, Format= (10I8)\n{} \
                 100 Real-header values follow on  20 lines, Format= (5F15.6)\n{}   \
                 2 Comment line(s) follow, each starting with a \"|\":\n| Sensor\n|<AUTH>\n   \
                 {count} {quantity} pts, approx  {:.0} secs, units={unit},Format=({format})\n",
                at + 1,
                motion.component,
                rows(&[-999.0; 100], 10, |value| format!("{value:>8}")),
                rows(&reals, 5, |value| format!("{value:>15.6}")),
                motion.duration(),
            );
            text += &match format {
                "1E15.6" => rows(&motion.samples, 1, |a| {
                    let (mantissa, exponent) = exponential(a);
                    format!("{:>15}", format!("{mantissa}e{exponent:+03}"))
                }),
                _ => rows(&motion.samples, 8, |a| format!("{a:>10.5}")),
            };
            let _ = writeln!(text, "End-of-data for Chan {} {quantity}", at + 1);
        }
    }
    text
}

fn exponential(value: f64) -> (String, i32) {
    let text = format!("{value:.6e}");
    let (mantissa, exponent) = text.split_once('e').unwrap();
    (mantissa.into(), exponent.parse().unwrap())
}

/// CSMIP volume 2 with numbers that touch (`8f10.6`), or in capitals without a unit in the line of the samples.
pub(super) fn csmip_v2(motions: &[Motion], capitals: bool) -> String {
    let mut text = String::new();
    for (at, motion) in motions.iter().enumerate() {
        let count = motion.samples.len();
        let (component, step) = (motion.component, bare(motion.step, 6, 3));
        let _ = write!(
            text,
            "Corrected accelerogram   15481673.CI.WLT.--.HN      Chan  {n}:  {component} Deg     from   \n\
             Uncorrected Accelerogram Data             Processed: 04/30/14, CGS  ciwlt1      \n\
             Rcrd of Fri Mar 28, 2014 21:09:34.0 PDT               (Avol1 v0.6, 3/14 CSMIP)  \n\
             15481673.CI.WLT.--.HN                Start time:  3/29/14, 04:09:34.0 UTC (GPS) \n\
             Station Id. WLT     34.009N, 117.951W            s/n 4310  (3 Chns of  3 at Sta)\n\
             Hacienda Heights                         SCSN   Data: Acceleration              \n\
             Chan  {n}:  {component} Deg\n \
             {count} points of instrument- and baseline-corrected accel, veloc and displ data \n\
             At equally-spaced intervals of    {step}  sec.\n\
             Peak acceleration =  {:>9.3}    cm/sec/sec  at   14.840   sec.\n\
             Peak   velocity   =    -6.863      cm/sec    at   14.680   sec.\n",
            motion.peak(),
            n = at + 1,
        );
        text += &rows(&[-999.0; 100], 16, |value| format!("{value:>5}"));
        text += &rows(&[-999.0; 100], 8, |_| "-999.00000".into());
        for (quantity, unit) in [("accel", "cm/sec2"), ("veloc", "cm/sec"), ("displ", "cm")] {
            let line = if capitals {
                format!("{count} points of {quantity} data equally spaced at {step} sec. (8f10.6)")
                    .to_uppercase()
            } else {
                format!(
                    " {count} points of {quantity} data equally spaced at {step} sec, in {unit}. (8f10.6)"
                )
            };
            let _ = writeln!(text, "{line}");
            // Of `f10.6` the last digits make room for larger numbers.
            text += &rows(&motion.samples, 8, |a| {
                bare(a, 10, 6).chars().take(10).collect()
            });
        }
        let _ = writeln!(
            text,
            "/&  ----------  End of data for channel {:>2}  ----------",
            at + 1
        );
    }
    text
}

/// CSMIP volume 1 in g.
pub(super) fn csmip_v1(motions: &[Motion]) -> String {
    let mut text = String::new();
    for (at, motion) in motions.iter().enumerate() {
        let (count, rate) = (motion.samples.len(), 1.0 / motion.step);
        let _ = write!(
            text,
            "Uncorrected Accelerogram Data             Processed: 02/13/12, CGS  146be002    \n\
             Record of Mon Feb 13, 2012 13:06:45.0 PST             (Avol1 v9.2,12/11 CSMIP)  \n\
             89146-L2500-12044.02                 Start time:  2/13/12, 21:06:45.0 UTC (GPS) \n\
             Station No. 89146   40.941N, 123.633W      Etna  s/n 2500  (3 Chns of  3 at Sta)\n\
             Willow Creek                              CGS                                   \n\
             Chan  {}: {} Deg\nUnits of uncor data are sec and g .        Max  =   {:.3} g \n",
            at + 1,
            motion.component,
            motion.peak().abs()
        );
        text += &rows(&[1.0; 100], 16, |value| format!("{value:>5}"));
        text += &rows(&[-999.0; 50], 8, |_| "-999.00000".into());
        let _ = writeln!(
            text,
            " {count} Accelerogram points at {rate} pts/sec in units of g .      Format: (8f9.6)  "
        );
        text += &rows(&motion.samples, 8, |a| bare(a, 9, 6));
        let _ = writeln!(
            text,
            "/&  ----------  End of data for channel {:>2}  ----------",
            at + 1
        );
    }
    text
}

/// GeoNet volume 1 (`volume` 1, acceleration alone) or 2.
pub(super) fn geonet(motions: &[Motion], volume: u32) -> String {
    let mut text = String::new();
    for motion in motions {
        let count = motion.samples.len();
        let peak = motion.peak();
        let (title, data, others) = match volume {
            1 => (
                "Uncorrected",
                "Raw readings in units of 1.00 mm/s/s  at intervals of",
                0,
            ),
            _ => ("Corrected", "Instrument corrected data at", count),
        };
        let end = if volume == 1 { "s" } else { "sec intervals" };
        let _ = write!(
            text,
            "{title} accelerogram 20180212_211554_WPWS_20 GNS Science\n\
             Site WPWS      39 56 38S  176 35 04E     Basalt file:  20180212_211557_WPWS\n\
             Waipawa District Council\nInstrument Basalt_2413\nResolution: 24-bit\n\
             Accelerogram 20180212_211554_WPWS_20\n6 km south of Waipukurau\n\
             2018 February 12         21:15:54 UT\n\
             Epicentre  40 03 27S 176 32 45E  Bearing S15W  Dist   13km  Depth    9km M  4.17\n\
             Number of points  {count}    Duration {:.2} sec\n{data} {:.3} {end}\nData is unfiltered\n\
             Component {}  Longitudinal Accelerometer Axis\n\
             Acceleration:  peak {peak:>8.1} mm/s/s at  43.68 sec     rms      2.2 mm/s/s\n\
             Velocity:      peak     1.65 mm/s\nDisplacement:  peak    0.131 mm\n",
            motion.duration(),
            motion.step,
            motion.component,
        );
        let counts = [count, others, others].map(|count| count as f64);
        text += &rows(&[9.0; 30], 10, |value| format!("{value:>8}"));
        let integers = [&counts[..], &[0.0; 4], &[15.0, 17000.0]].concat();
        // The counts are the fourth to sixth of the last row of integers.
        let row = [&[21200.0, 250.0, 250.0], &integers[..7]].concat();
        text += &rows(&row, 10, |value| format!("{value:>8}"));
        text += &rows(&[0.7; 60], 10, |value| format!("{value:>8}"));
        for _ in 0..if volume == 1 { 1 } else { 3 } {
            text += &rows(&motion.samples, 10, |a| format!("{a:>8.1}"));
        }
    }
    text
}

/// ESM, ITACA or (`network` TK) AFAD.
pub(super) fn esm(motion: &Motion, network: &str) -> String {
    let name = if network == "TK" { "None" } else { "GREECE" };
    let mut text = format!(
        "EVENT_NAME: {name}\nEVENT_ID: EMSC-20190728_0000106\nEVENT_DATE_YYYYMMDD: 20190728\n\
         MAGNITUDE_W: \nNETWORK: {network}\nSTATION_CODE: ARS1\nVS30_M/S: \n\
         DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS: 20190728_160919.870\n\
         SAMPLING_INTERVAL_S: {:.6}\nNDATA: {}\nDURATION_S: {:.3}\nSTREAM: {}\nUNITS: cm/s^2\n\
         INSTRUMENT: sensor = CMG_5TD [Unknown] | digitizer = Unknown [Unknown]\n\
         PGA_CM/S^2: {:.6}\nTIME_PGA_S: 20.670000\nDATA_TYPE: ACCELERATION\nUSER5: \n",
        motion.step,
        motion.samples.len(),
        motion.duration(),
        motion.component,
        motion.peak()
    );
    text += &rows(&motion.samples, 1, |a| format!("{a:.6}"));
    text
}

/// SMC of the U. S. Geological Survey, with numbers that touch.
pub(super) fn smc(motion: &Motion, comments: usize) -> String {
    let mut integers = vec![-32768.0; 48];
    integers[1..6].copy_from_slice(&[1989.0, 291.0, 0.0, 4.0, 7.0]);
    integers[15] = comments as f64;
    integers[16] = motion.samples.len() as f64;
    let mut reals = vec![1.7e38; 50];
    reals[1] = 1.0 / motion.step;
    reals[29] = motion.samples.iter().copied().fold(0.0, f64::max);
    reals[31] = motion.samples.iter().copied().fold(0.0, f64::min);
    let blank = "*\n";
    let mut text = format!(
        "2 CORRECTED ACCELEROGRAM\n{blank}SAF0A\n     1989  10  18    0004 Loma Prieta, CA\n\
         Moment Mag=      7.1\nstation = San Francisco, 1295 Shafter, F component=    {}\n\
         epicentral dist =     89.0\ninst type=SMA-1\n{blank}{blank}{blank}",
        motion.component
    );
    text += &rows(&integers, 8, |value| format!("{value:>10}"));
    text += &rows(&reals, 5, |value| {
        let (mantissa, exponent) = exponential(value);
        format!("{:>15}", format!("{mantissa}E{exponent:+03}"))
    });
    text += &"|ref - 1989\n".repeat(comments);
    text += &rows(&motion.samples, 8, |a| {
        let text = format!("{a:.4e}");
        let (mantissa, exponent) = text.split_once('e').unwrap();
        let exponent: i32 = exponent.parse().unwrap();
        format!("{:>10}", format!("{mantissa}E{exponent:+}"))
    });
    text
}

/// Strong motion of Taiwan.
pub(super) fn cwb(motions: &[Motion]) -> String {
    let first = &motions[0];
    let mut text = format!(
        "#Earthquake Information\n#Origin Time(GMT+08): 2018/02/06-23:50:42\n#Magnitude(Ml): 6.0\n\n\
         #Station Information\n#StationCode: EAS\n#StartTime(GMT+08): 2018/02/06-23:50:29.000\n\
         #RecordLength(sec): {}\n#SampleRate(Hz): {}\n#AmplitudeUnit:  gal. DCoffset(corr)\n",
        first.duration().round(),
        1.0 / first.step
    );
    for motion in motions {
        let (most, least) = motion
            .samples
            .iter()
            .fold((0.0_f64, 0.0_f64), |(a, b), s| (a.max(*s), b.min(*s)));
        let _ = writeln!(
            text,
            "#AmplitudeMAX. {}: {most:>8.3}~ {least:>8.3}",
            motion.component
        );
    }
    let names: Vec<String> = motions
        .iter()
        .map(|motion| format!("{}(+)", motion.component))
        .collect();
    let _ = write!(
        text,
        "#DataSequence: Time {}\n#Data: 4F10.3 \n",
        names.join("; ")
    );
    for index in 0..first.samples.len() {
        let _ = write!(text, "{:>10.3}", index as f64 * first.step);
        for motion in motions {
            let _ = write!(text, "{:>10.3}", motion.samples[index]);
        }
        text.push_str("\r\n");
    }
    text
}

/// Strong motion of China.
pub(super) fn csmnc(motion: &Motion, year: u32) -> String {
    let mut text = format!(
        "051BXD130420080201\n0130420080246 {year}-04-20 8:2:46 BTM\nLUSHAN EARTHQUAKE, LUSHAN,CHN\n\
         EPICENTER  30.300N 103.000E DEPTH 13 KM\nMAGNITUDE  7.0(Ms)\nSTATION: 51BXD 30.400N 102.800E\n\
         SITE CONDITION: ROCK\nINSTRUMENT TYPE: MR2002/SLJ-100\nOBSERVING POINT: GROUND\n\
         COMP. {}\nUNCORRECTED ACCELERATION          UNIT: CM/SEC/SEC\n\
         NO. OF POINTS:  {}  EQUALLY SPACED INTERVALS OF:  {}  SEC\n\
         PEAK VALUE:    {:.3}   AT   26.35 SEC    DURATION:  60 SEC\nPRE-EVENT TIME:  20  SEC\nCSMNC\n\n",
        motion.component,
        motion.samples.len(),
        motion.step,
        motion.peak()
    );
    text += &rows(&motion.samples, 8, |a| {
        let (mantissa, exponent) = exponential(a);
        format!("{:>13}", format!("{mantissa}E{exponent}"))
    });
    text
}

/// Strong motion of Turkey until 2018.
pub(super) fn afad(motions: &[Motion]) -> String {
    let peaks: Vec<String> = motions
        .iter()
        .map(|motion| format!("({}) {:.6}", motion.component, motion.peak().abs()))
        .collect();
    let names: String = motions
        .iter()
        .map(|motion| format!("{:>13}", motion.component))
        .collect();
    let mut text = format!(
        "STRONG GROUND MOTION RECORDS OF TURKIYE\nPLACE                   : GERMENCIK DEVLET HASTANESI\n\
         EARTHQUAKE DATE         : 2017/07/20 22:31:09 (GMT)\nSTATION ID              : 0921\n\
         RECORD TIME             : 20/07/2017 22:30:58.000000 (GMT)\nNUMBER OF DATA          : {}\n\
         SAMPLING INTERVAL (sec) : {}\nRAW PGA VALUES (gal)    : {}\n\
         DISASTER AND EMERGENCY MANAGEMENT PRESIDENCY\n{names}\n",
        motions[0].samples.len(),
        motions[0].step,
        peaks.join(" ")
    );
    for index in 0..motions[0].samples.len() {
        for motion in motions {
            let _ = write!(text, "{:>13.6}", motion.samples[index]);
        }
        text.push('\n');
    }
    text
}

/// PEER AT2, of 1997 or of NGA-West2.
pub(super) fn at2(motion: &Motion, year: u32) -> String {
    let line = match year {
        1997 => format!("  {}  {:.4}  NPTS, DT", motion.samples.len(), motion.step),
        _ => format!(
            "NPTS=   {}, DT=   {:.4} SEC,",
            motion.samples.len(),
            motion.step
        ),
    };
    let head = "PEER NGA STRONG MOTION DATABASE RECORD\nImperial Valley-02, 5/19/1940\n\
                ACCELERATION TIME SERIES IN UNITS OF G\n";
    let data = rows(&motion.samples, 5, |a| format!("{a:>15.7}"));
    format!("{head}{line}\n{data}")
}
