// Errors of the server in words that a person can act on.

import { words } from "../language/words.ts";
import type { Problem } from "./types.ts";

/** An answer other than success. Status 0: no answer at all. */
export class ApiError extends Error {
  readonly status: number;
  readonly problem: Partial<Problem>;

  constructor(status: number, problem: Partial<Problem>) {
    super(problem.title ?? words().problems.answered(String(status)));
    this.name = "ApiError";
    this.status = status;
    this.problem = problem;
  }
}

/** What there is to say where no answer came at all. */
export function noAnswer(): ApiError {
  return new ApiError(0, { title: words().problems.noAnswer, detail: words().problems.noAnswerMore });
}

export function isWithoutAnswer(reason: unknown): boolean {
  return reason instanceof ApiError && reason.status === 0;
}

/** The problem document of an answer, or one made from its status where it carries none. */
export async function problemFromResponse(response: Response): Promise<Partial<Problem>> {
  const otherwise: Partial<Problem> = {
    title: words().problems.answered(`${response.status} ${response.statusText}`.trim()),
    status: response.status,
  };
  if (!(response.headers.get("content-type") ?? "").includes("json")) return otherwise;
  try {
    return { ...otherwise, ...((await response.json()) as Problem) };
  } catch {
    return otherwise;
  }
}

/** A headline and the sentences below it. */
export interface ProblemText {
  headline: string;
  sentences: string[];
}

export function describeProblem(reason: unknown): ProblemText {
  if (!(reason instanceof ApiError)) {
    return { headline: words().problems.headline, sentences: [reason instanceof Error ? reason.message : String(reason)] };
  }
  const { problem } = reason;
  const sentences = problem.detail === undefined ? [] : [problem.detail];
  for (const error of problem.errors ?? []) {
    const value = error.value === undefined || error.value === null ? "" : ` = ${error.value}`;
    const sentence = words().problems.allowed(`${error.parameter}${value}`, error.message, error.allowed);
    if (sentence !== problem.detail) sentences.push(sentence);
  }
  return { headline: reason.message, sentences };
}
