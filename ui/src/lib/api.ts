// The service, as its OpenAPI schema describes it.
import type { components, paths } from "../schema";

export type Shapes = components["schemas"];
export type DesignState = Shapes["DesignState"];
export type Operation = Shapes["Edits"]["operations"][number];
export type Health = Shapes["Health"];
export type Problem = Shapes["Problem"];

type Json<T> = T extends { responses: { 200: { content: { "application/json": infer R } } } } ? R : never;
type BodyOf<T> = T extends { requestBody: { content: { "application/json": infer B } } } ? B : undefined;
type Method = "get" | "post" | "put" | "delete";
type With<M extends Method> = { [P in keyof paths]: paths[P] extends Record<M, infer T> ? (T extends undefined ? never : P) : never }[keyof paths];
type Of<P extends keyof paths, M extends Method> = paths[P] extends Record<M, infer T> ? T : never;
type Query = Record<string, string | number | boolean | string[] | null | undefined>;

export interface Outside {
  message: string;
  digest: string;
  changes: string[];
}

/** The service said no, and why. */
export class Refused extends Error {
  constructor(
    readonly status: number,
    message: string,
    readonly place: string[] = [],
    readonly current?: DesignState,
    /** Of a file that was changed by hand: its digest now, and the changes. */
    readonly outside?: Outside,
  ) {
    super(message);
  }
}

function address(path: string, query: Query): string {
  const rest = new URLSearchParams();
  let filled = path;
  for (const [key, value] of Object.entries(query)) {
    if (filled.includes(`{${key}}`)) filled = filled.replace(`{${key}}`, encodeURIComponent(String(value)));
    else if (Array.isArray(value)) value.forEach((one) => rest.append(key, one));
    else if (value != null) rest.set(key, String(value));
  }
  const said = rest.toString();
  return `.${filled}${said ? `?${said}` : ""}`;
}

async function answer(method: Method, path: string, query: Query, body?: unknown, signal?: AbortSignal): Promise<Response> {
  const raw = body instanceof Blob;
  let response: Response;
  try {
    response = await fetch(address(path, query), {
      method: method.toUpperCase(),
      body: body === undefined ? undefined : raw ? body : JSON.stringify(body),
      headers: body === undefined ? {} : { "content-type": raw ? "application/octet-stream" : "application/json" },
      signal,
    });
  } catch (error) {
    if (signal?.aborted) throw error;
    throw new Refused(0, "the service does not answer; is robophm serve still running?");
  }
  if (response.ok) return response;
  if (response.status === 401) location.reload(); // which asks to log in
  const why = (await said(response)) as { message?: string; place?: string[]; current?: DesignState } & Partial<Outside>;
  const message = why.message ?? `refused (${response.status})`;
  const outside = why.digest ? { message, digest: why.digest, changes: why.changes ?? [] } : undefined;
  throw new Refused(response.status, message, why.place, why.current, outside);
}

async function said(response: Response): Promise<unknown> {
  const text = await response.text();
  try {
    return JSON.parse(text);
  } catch {
    throw new Refused(response.status, `the service answered what is no JSON (${response.status})`);
  }
}

async function ask(method: Method, path: string, query: Query, body?: unknown, signal?: AbortSignal): Promise<unknown> {
  return said(await answer(method, path, query, body, signal));
}

/** What is no JSON: a file as it is. */
export async function file(path: With<"get">, query: Query = {}): Promise<Blob> {
  return (await answer("get", path, query)).blob();
}

export function get<P extends With<"get">>(path: P, query: Query = {}, signal?: AbortSignal): Promise<Json<Of<P, "get">>> {
  return ask("get", path, query, undefined, signal) as Promise<Json<Of<P, "get">>>;
}

export function post<P extends With<"post">>(path: P, body: BodyOf<Of<P, "post">>, query: Query = {}): Promise<Json<Of<P, "post">>> {
  return ask("post", path, query, body) as Promise<Json<Of<P, "post">>>;
}

export function put<P extends With<"put">>(path: P, body: BodyOf<Of<P, "put">>): Promise<Json<Of<P, "put">>> {
  return ask("put", path, {}, body) as Promise<Json<Of<P, "put">>>;
}

export function remove<P extends With<"delete">>(path: P, query: Query): Promise<Json<Of<P, "delete">>> {
  return ask("delete", path, query) as Promise<Json<Of<P, "delete">>>;
}

export function upload<P extends With<"post">>(path: P, file: Blob, query: Query): Promise<Json<Of<P, "post">>> {
  return ask("post", path, query, file) as Promise<Json<Of<P, "post">>>;
}

/** A file of any size, with the share of it that has gone over so far. */
export function send<P extends With<"post">>(path: P, file: Blob, query: Query, gone: (share: number) => void): Promise<Json<Of<P, "post">>> {
  return new Promise((resolve, reject) => {
    const request = new XMLHttpRequest(); // fetch does not say how far it is
    request.open("POST", address(path, query));
    request.setRequestHeader("content-type", "application/octet-stream");
    request.upload.onprogress = (event) => gone(event.loaded / Math.max(event.total, 1));
    request.onerror = () => reject(new Refused(0, "the service took no more of it, or does not answer"));
    request.onload = () => {
      try {
        const found = JSON.parse(request.responseText) as Json<Of<P, "post">> & { message?: string };
        if (request.status === 200) resolve(found);
        else reject(new Refused(request.status, found.message ?? `refused (${request.status})`));
      } catch {
        reject(new Refused(request.status, `the service answered what is no JSON (${request.status})`));
      }
    };
    request.send(file);
  });
}
