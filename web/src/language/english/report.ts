// The words of the report.

export const report = {
  report: {
    brand: "Skyglow · Report",
    /** Then the place. */
    title: "The night sky",
    /** Of the file: without signs that file names cannot have. */
    titleOf: (place: string) => `The night sky, ${place}`,
    made: (date: string) => `Made on ${date}`,
    print: "Print or PDF",
    save: "Save as HTML",
    close: "Back",
    waiting: "Putting the report together…",
    ground: (altitudeM: string) => `${altitudeM} m above sea level`,
    picture: "The sky all around, from north over east, south and west to north; the zenith is the upper edge.",
    pictureOf: (place: string) => `The sky over ${place}`,
    today: "Today",
    /** Captions of a picture before or after: what it shows, and which eye sees it. */
    toTodaysEye: (title: string) => `${title}, to an eye adapted to the sky of today`,
    toKeptEye: (title: string, luminance: string) => `${title}, to an eye kept adapted to ${luminance}`,
    numbers: "The sky in numbers",
    meaning: "What it means",
    /** `mag`: of the natural sky. */
    zenith: (mag: string) => `Smaller is brighter. The natural sky alone has ${mag}.`,
    zenithOf: "Smaller is brighter.",
    bortle: (name: string) => `${name}. From 1, excellently dark, to 9.`,
    ratio: "Artificial light overhead over that of the natural sky.",
    illuminance: (artificial: string) => `From the whole sky; ${artificial} of it is artificial.`,
    faintest: "The faintest seen overhead. Larger means more stars.",
    sqm: "What a hand-held meter reads when it points overhead.",
    stars: (all: string) => `Of ${all} above the horizon under a dark sky.`,
    shares: "Whose light it is",
    sharesLead: "Shares of the artificial light overhead, by town; lights count for the nearest town that reaches so far.",
    town: "Town",
    where: "Where",
    share: "Share",
    areas: (file: string) => `The same by the areas of ${file}`,
    area: "Area",
    plan: "With the plan",
    painted: "With the changed lights",
    planLead: (share: string, flux: string, dimmed: string) =>
      `The plan takes ${share} of the light within 300 km away (${flux} upward, as the satellite sees it), from ${dimmed} lit pixels of the map.`,
    paintedLead: (pixels: string) => `${pixels} lit pixels of the map have other lights.`,
    withItsPlan: "The numbers include the effect of the plan that this lies on.",
    withItsBase: "The numbers include the effect of the changed lights that this lies on.",
    what: "What",
    effect: "Whose light is dimmed, by its part in the plan's effect",
    assumptions: "What was assumed",
    assumedLamps:
      "A satellite sees no blue light: which lamps shine is an assumption, not a measurement, and the light of single lamps is not told apart.",
    time: "Time",
    credit: "Data and method",
    lights: "Lights",
    places: "Names of places",
    method: "Method",
    methodText:
      "The light of every lit pixel within 300 km, scattered by air and haze, after Dobashi, Ishikawa and Iwasaki, ACM Transactions on Graphics 42(6) 219, 2023.",
    link: "Live view",
  },
};

export type ReportWords = typeof report;
