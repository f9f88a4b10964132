// The viewer's names for the answers of the API.

import type { PlaceAnswer, QuantitiesAnswer, SceneAnswer, SiteAnswer } from "./schema.ts";

export type {
  AreaShare,
  AreaSharesAnswer as AreaShares,
  AtmosphereAnswer as Atmosphere,
  CalendarNight,
  DarkerAnswer as Darker,
  DarkerPlaceAnswer as DarkerPlace,
  DimmedPixelAnswer as DimmedPixel,
  FoundPlace,
  InfluentialPixel,
  Night,
  NightHourAnswer as NightHour,
  NightHoursAnswer as NightHours,
  NightSkyAnswer as NightSky,
  PanoramaAnswer,
  PlaceShare,
  PlanAnswer as Plan,
  PlannedSite,
  Problem,
  ScenarioAnswer as Scenario,
  SharesAnswer as Shares,
  SkyAnswer,
  TileJson,
} from "./schema.ts";
export type Scene = SceneAnswer;

export type NamedPlace = PlaceAnswer;
export type Site = SiteAnswer;
export type SkyQuantities = QuantitiesAnswer;
/** Four numbers, [west, south, east, north] in degrees; west > east across the antimeridian. */
export type Bounds = SceneAnswer["bounds"];
